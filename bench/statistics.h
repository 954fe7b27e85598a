// SPDX-License-Identifier: BSD-3-Clause
// Medians and quantiles.
#ifndef HF_BENCH_STATISTICS_H
#define HF_BENCH_STATISTICS_H

// Sort n numbers and return the median; for an even n, the lower of the two middle ones.
double bench_median(double *numbers, int n);

// The q-quantile of n sorted numbers, interpolated linearly between neighbours.
double bench_quantile(const double *sorted, int n, double q);

#endif
