// SPDX-License-Identifier: Apache-2.0
#include "medium/medium.h"

#include "phase/phase.h"

static const struct entry *const entries[] = {
#define X(name) &medium_##name.entry,
#include "medium/list.h"
#undef X
    NULL,
};

const struct registry media = {"medium", entries};

bool medium_prepare(struct object *self, struct arena *arena, struct medium *m) {
    *m = (struct medium){.type = medium_type_of(self), .data = self->data};
    if (!m->type->prepare(self, arena, m))
        return false;
    m->plain = m->homogeneous && m->grey && m->scatters && !m->emits;
    return true;
}

void medium_init(struct medium *m, const struct medium_common *common, float mean_cosine,
                 struct arena *arena) {
    m->phase = common->phase ? common->phase : phase_default(mean_cosine, arena);
    m->sample_emitters = common->sample_emitters;
    m->scale = common->scale;
    m->emits = !spectrum_is_black(volume_maximum(&common->emission));
}
