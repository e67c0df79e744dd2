// SPDX-License-Identifier: Apache-2.0
#include "check.h"
#include "math/elementary.h"

int main(void) {
    double e = 0, l = 0, s = 0;
    for (int i = 0; i <= 1000000; i++) {
        const float x = -86.9f + (float)i * 174.8e-6f, y = expf(x), u = (float)i * 2e-6f - 1;
        float sine, cosine;
        e = fmax(e, fabs(fast_exp(x) / exp(x) - 1));
        l = fmax(l, fabs(fast_log(y) - log(y)) / fmax(1, fabs(log(y))));
        sincos_turn(u, &sine, &cosine);
        s = fmax(s, fmax(fabs(sine - sin(2 * M_PI * u)), fabs(cosine - cos(2 * M_PI * u))));
    }
    CHECK_NEAR(e, 0, 2.4e-7);
    CHECK_NEAR(l, 0, 2.4e-7);
    CHECK_NEAR(s, 0, 2.4e-7);
    CHECK(fast_exp(0) == 1 && fast_log(1) == 0);
    CHECK(fast_exp(-1000) == 0 && fast_exp(-INFINITY) == 0 && fast_exp(NAN) == 0);
    CHECK(isfinite(fast_exp(1000)));
    return check_result();
}
