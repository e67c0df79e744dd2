// SPDX-License-Identifier: Apache-2.0
// Media, one a line; each is medium/NAME.c.
X(homogeneous)
X(heterogeneous)
