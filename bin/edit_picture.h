// SPDX-License-Identifier: Apache-2.0
// The picture that relume edit writes, and what it cost.
#pragma once

#include "edit_session.h"
#include "replay/edit.h"
#include "replay_report.h"

// frame: three planes; variance: one. false after an error message.
bool edit_picture(const struct replay_values *c, const struct edit_session *s, struct edit *edit,
                  float *frame, struct replay_timing *t, float *variance);
