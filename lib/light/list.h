// SPDX-License-Identifier: Apache-2.0
// Lights, one a line; each is light/NAME.c.
X(area)
X(constant)
X(directional)
X(envmap)
X(ies)
X(point)
X(projector)
X(spot)
X(sunsky)
