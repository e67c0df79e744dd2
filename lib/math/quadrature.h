// SPDX-License-Identifier: Apache-2.0
// Gauss-Legendre quadrature, for tables built before rendering and for tests.
#pragma once

// Nodes (ascending) and weights of the n-point rule on [0, 1]; the weights sum to 1. n >= 1.
void gauss_legendre(int n, double *nodes, double *weights);
