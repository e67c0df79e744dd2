// SPDX-License-Identifier: Apache-2.0
// Phase functions, one a line; each is phase/NAME.c.
X(isotropic)
X(hg)
X(rayleigh)
X(blendphase)
X(tabphase)
