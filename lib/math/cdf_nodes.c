// SPDX-License-Identifier: Apache-2.0
#include "math/cdf_nodes.h"

#include "base/mem.h"

void cdf_nodes_init(struct cdf_nodes *n, size_t rows, int count) {
    size_t numbers = (size_t)count + 1;
    *n = (struct cdf_nodes){0};
    do {
        const size_t nodes = (numbers + CDF_NODE - 1) / CDF_NODE;
        n->width[n->levels] = CDF_NODE * nodes;
        n->level[n->levels++] = mem_array(rows * CDF_NODE * nodes, sizeof(float));
        numbers = nodes;
    } while (numbers > 1);
    for (int level = 0; level < n->levels; level++)
        for (size_t i = 0; i < rows * n->width[level]; i++)
            n->level[level][i] = 1;
}

void cdf_nodes_finish(struct cdf_nodes *n) {
    for (int level = 0; level < n->levels; level++)
        mem_free(n->level[level]);
    *n = (struct cdf_nodes){0};
}

void cdf_nodes_index(struct cdf_nodes *n, size_t row) {
    for (int level = 1; level < n->levels; level++) {
        const float *from = n->level[level - 1] + row * n->width[level - 1];
        float *to = n->level[level] + row * n->width[level];
        for (size_t i = 0; i < n->width[level - 1] / CDF_NODE; i++)
            to[i] = from[CDF_NODE * i];
    }
}
