// SPDX-License-Identifier: Apache-2.0
// Materials, one a line; each is bsdf/NAME.c.
X(conductor)
X(dielectric)
X(diffuse)
X(mask)
X(null)
X(plastic)
X(roughconductor)
X(twosided)
