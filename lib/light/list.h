// SPDX-License-Identifier: Apache-2.0
// Lights, one a line; each is light/NAME.c.
X(area)
X(constant)
X(directional)
X(envmap)
X(point)
X(spot)
X(sunsky)
