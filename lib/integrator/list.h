// SPDX-License-Identifier: Apache-2.0
// Integrators, one a line; each is integrator/NAME.c.
X(path)
X(volpath)
X(volpathmis)
X(dipole)
X(direct)
X(aov)
X(moment)
X(simple)
X(relit)
X(stored)
