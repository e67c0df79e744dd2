// SPDX-License-Identifier: Apache-2.0
// Student's t: a normal deviate in units of a standard error that is known from few values itself.
#pragma once

// |t| is below this with probability 0.95.
double student_95(int degrees);

// Probability that |t| is exceeded; degrees > 0, INFINITY: the normal distribution.
double student_p_value(double t, double degrees);
