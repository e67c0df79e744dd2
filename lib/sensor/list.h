// SPDX-License-Identifier: Apache-2.0
// Sensors, one a line; each is sensor/NAME.c.
X(irradiancemeter)
X(orthographic)
X(perspective)
X(radiancemeter)
X(texels)
X(thinlens)
X(vertices)
