// SPDX-License-Identifier: Apache-2.0
// Textures, one a line; each is texture/NAME.c.
X(bitmap)
X(checkerboard)
X(mesh_attribute)
X(product)
X(step)
X(uvmap)
