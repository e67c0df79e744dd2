// SPDX-License-Identifier: Apache-2.0
// Materials, one a line; each is bsdf/NAME.c.
X(diffuse)
