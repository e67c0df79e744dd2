// SPDX-License-Identifier: Apache-2.0
// Samplers, one a line; each is sampler/NAME.c.
X(independent)
X(lattice)
X(multijitter)
X(sobol)
X(stratified)
X(zsobol)
