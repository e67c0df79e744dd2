// SPDX-License-Identifier: Apache-2.0
// Reconstruction filters, one a line; each is filter/NAME.c.
X(box)
X(catmullrom)
X(gaussian)
X(lanczos)
X(mitchell)
X(tent)
