// SPDX-License-Identifier: Apache-2.0
// Volumes, one a line; each is volume/NAME.c.
X(constvolume)
X(gridvolume)
