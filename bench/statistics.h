// SPDX-License-Identifier: BSD-3-Clause
// The middle of some numbers.
#ifndef HF_BENCH_STATISTICS_H
#define HF_BENCH_STATISTICS_H

// Sort n numbers, and return the middle one, of an even number the lower of the two.
double bench_median(double *numbers, int n);

// The value below which the share q of n sorted numbers lies, between the numbers beside it, as n - 1 steps.
double bench_quantile(const double *sorted, int n, double q);

#endif
