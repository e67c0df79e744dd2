// SPDX-License-Identifier: Apache-2.0
// OpenCL: a device, its memory and the project's kernels. The only module that sees OpenCL.
//
// Everything here may be absent: compute_open gives NULL where there is no device (or no platform, or a
// broken one), and callers then run the C twin of a kernel. Kernels are OpenCL 1.2 C, one operation a
// file in kernels/, and part of the program. A failing call is a broken device: it prints one error
// and gives false or NULL.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct compute_device;

// The device that suits best: a GPU, else a CPU. NULL: none; says why at level info.
struct compute_device *compute_open(void);
void compute_close(struct compute_device *d); // NULL is fine
const char *compute_name(const struct compute_device *d);
bool compute_is_cpu(const struct compute_device *d);
size_t compute_memory(const struct compute_device *d);           // bytes
size_t compute_most_allocation(const struct compute_device *d);  // bytes of one buffer
double compute_build_seconds(const struct compute_device *d);    // spent compiling kernels so far

struct compute_buffer {
    void *handle; // NULL: none
    size_t bytes;
};

// Memory of the device, zero. handle == NULL after an error message.
struct compute_buffer compute_buffer_create(struct compute_device *d, size_t bytes);
// The device's view of the caller's memory, which must stay and must begin at a multiple of 128: no
// copy where the device shares the host's memory.
struct compute_buffer compute_buffer_wrap(struct compute_device *d, const void *data, size_t bytes);
// Room for results, which compute_collect puts at `data`; that begins like the memory above, and is
// where the device itself writes if it shares the host's memory.
struct compute_buffer compute_buffer_over(struct compute_device *d, void *data, size_t bytes);
bool compute_collect(struct compute_device *d, const struct compute_buffer *b, void *data);
void compute_buffer_destroy(struct compute_buffer *b);
bool compute_write(struct compute_device *d, struct compute_buffer *b, size_t offset, const void *data, size_t bytes);
bool compute_read(struct compute_device *d, const struct compute_buffer *b, size_t offset, void *data, size_t bytes);
bool compute_clear(struct compute_device *d, struct compute_buffer *b);

struct compute_kernel; // owned by the device

// Kernel `name` of kernels/`file`.cl, compiled once per device. NULL after an error message.
struct compute_kernel *compute_kernel(struct compute_device *d, const char *file, const char *name);

struct compute_arg {
    const struct compute_buffer *buffer; // or
    uint32_t u;                     // a uint
    float f;                        // or a float
    enum { COMPUTE_ARG_BUFFER, COMPUTE_ARG_UINT, COMPUTE_ARG_FLOAT } kind;
};

#define COMPUTE_BUFFER(b) ((struct compute_arg){.buffer = (b), .kind = COMPUTE_ARG_BUFFER})
#define COMPUTE_UINT(v) ((struct compute_arg){.u = (v), .kind = COMPUTE_ARG_UINT})
#define COMPUTE_FLOAT(v) ((struct compute_arg){.f = (v), .kind = COMPUTE_ARG_FLOAT})

// Queues one run over `items` work-items; runs happen in order. compute_read waits for them.
bool compute_run(struct compute_device *d, struct compute_kernel *k, size_t items, const struct compute_arg *args,
            uint32_t count);
bool compute_wait(struct compute_device *d);
