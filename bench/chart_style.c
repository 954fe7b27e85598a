// SPDX-License-Identifier: BSD-3-Clause
#include "page_chart.h"

const char chart_style[] =
#include "chart_css.h"
    ;
