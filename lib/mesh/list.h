// SPDX-License-Identifier: Apache-2.0
// Mesh file formats, one a line; each is mesh/NAME.c.
X(obj)
X(ply)
X(serialized)
