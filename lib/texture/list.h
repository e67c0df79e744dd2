// SPDX-License-Identifier: Apache-2.0
// Textures, one a line; each is texture/NAME.c.
