// SPDX-License-Identifier: Apache-2.0
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "cl/compute.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "cl/sources.h"

enum { MOST_PLATFORMS = 16, MOST_KERNELS = 64, MOST_FILES = 32 };

struct compute_kernel {
    char name[64];
    cl_kernel handle;
};

struct compute_device {
    cl_device_id id;
    cl_context context;
    cl_command_queue queue;
    char name[256];
    bool is_cpu;
    cl_ulong memory, most_allocation;
    double build_seconds;
    cl_program programs[MOST_FILES]; // by index of the file in compute_sources
    struct compute_kernel kernels[MOST_KERNELS];
    int kernel_count;
};

static bool check(cl_int code, const char *what) {
    if (code == CL_SUCCESS)
        return true;
    log_error("OpenCL: %s failed with code %d; OCL_ICD_VENDORS=/nonexistent goes without", what, code);
    return false;
}

// ---- device -------------------------------------------------------------------------------------

// The first device of a kind over all platforms.
static bool find_device(cl_device_type type, cl_device_id *id) {
    cl_platform_id platforms[MOST_PLATFORMS];
    cl_uint count = 0;
    if (clGetPlatformIDs(MOST_PLATFORMS, platforms, &count) != CL_SUCCESS)
        return false;
    for (cl_uint i = 0; i < count && i < MOST_PLATFORMS; i++)
        if (clGetDeviceIDs(platforms[i], type, 1, id, NULL) == CL_SUCCESS)
            return true;
    return false;
}

static bool find_best(cl_device_id *id) {
    return find_device(CL_DEVICE_TYPE_GPU, id) || find_device(CL_DEVICE_TYPE_CPU, id) ||
           find_device(CL_DEVICE_TYPE_ALL, id);
}

static bool survives;

// A driver may call abort() where something of the system is missing: ask in a child first. Only before
// the driver has threads here, one of which might hold a lock that the child then waits for for ever.
static void probe(void) {
    int status;
    const pid_t child = fork();
    if (child == 0) {
        cl_device_id id;
        cl_int code = 1;
        freopen("/dev/null", "w", stderr);
        if (find_best(&id))
            clCreateContext(NULL, 1, &id, NULL, NULL, &code);
        _exit(code != CL_SUCCESS);
    }
    survives = child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
               WEXITSTATUS(status) == 0;
}

struct compute_device *compute_open(void) {
    cl_int code = 0;
    cl_device_type type = 0;
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, probe);
    if (!survives) {
        log_info("there is no OpenCL device: computing without");
        return NULL;
    }
    struct compute_device *d = mem_array(1, sizeof *d);
    bool opened = find_best(&d->id);
    if (opened) {
        d->context = clCreateContext(NULL, 1, &d->id, NULL, NULL, &code);
        opened = check(code, "clCreateContext");
    }
    if (opened) {
        d->queue = clCreateCommandQueue(d->context, d->id, 0, &code);
        opened = check(code, "clCreateCommandQueue");
    }
    if (!opened) {
        compute_close(d);
        return NULL;
    }
    clGetDeviceInfo(d->id, CL_DEVICE_NAME, sizeof d->name - 1, d->name, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof d->memory, &d->memory, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof d->most_allocation,
                    &d->most_allocation, NULL);
    d->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    return d;
}

void compute_close(struct compute_device *d) {
    if (!d)
        return;
    for (int i = 0; i < d->kernel_count; i++)
        clReleaseKernel(d->kernels[i].handle);
    for (int i = 0; i < MOST_FILES; i++)
        if (d->programs[i])
            clReleaseProgram(d->programs[i]);
    if (d->queue)
        clReleaseCommandQueue(d->queue);
    if (d->context)
        clReleaseContext(d->context);
    mem_free(d);
}

const char *compute_name(const struct compute_device *d) {
    return d->name;
}

bool compute_is_cpu(const struct compute_device *d) {
    return d->is_cpu;
}

size_t compute_memory(const struct compute_device *d) {
    return d->memory;
}

size_t compute_most_allocation(const struct compute_device *d) {
    return d->most_allocation;
}

double compute_build_seconds(const struct compute_device *d) {
    return d->build_seconds;
}

// ---- memory -------------------------------------------------------------------------------------

struct compute_buffer compute_buffer_create(struct compute_device *d, size_t bytes) {
    cl_int code;
    struct compute_buffer b = {clCreateBuffer(d->context, CL_MEM_READ_WRITE, bytes ? bytes : 1, NULL,
                                              &code), bytes};
    if (!check(code, "clCreateBuffer") || !compute_clear(d, &b))
        compute_buffer_destroy(&b);
    return b;
}

struct compute_buffer compute_buffer_wrap(struct compute_device *d, const void *data, size_t bytes) {
    cl_int code;
    const cl_mem_flags use = d->is_cpu ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR;
    struct compute_buffer b = {clCreateBuffer(d->context, CL_MEM_READ_ONLY | use, bytes,
                                              (void *)data, &code), bytes};
    if (!check(code, "clCreateBuffer"))
        b = (struct compute_buffer){0};
    return b;
}

struct compute_buffer compute_buffer_over(struct compute_device *d, void *data, size_t bytes) {
    cl_int code;
    const cl_mem_flags use = d->is_cpu ? CL_MEM_USE_HOST_PTR : 0;
    struct compute_buffer b = {clCreateBuffer(d->context, CL_MEM_READ_WRITE | use, bytes,
                                              d->is_cpu ? data : NULL, &code), bytes};
    if (!check(code, "clCreateBuffer"))
        b = (struct compute_buffer){0};
    return b;
}

void compute_buffer_destroy(struct compute_buffer *b) {
    if (b->handle)
        clReleaseMemObject(b->handle);
    *b = (struct compute_buffer){0};
}

bool compute_write(struct compute_device *d, struct compute_buffer *b, size_t offset,
                   const void *data, size_t bytes) {
    return check(clEnqueueWriteBuffer(d->queue, b->handle, CL_TRUE, offset, bytes, data, 0, NULL, NULL),
                 "clEnqueueWriteBuffer");
}

bool compute_read(struct compute_device *d, const struct compute_buffer *b, size_t offset, void *data,
                  size_t bytes) {
    return check(clEnqueueReadBuffer(d->queue, b->handle, CL_TRUE, offset, bytes, data, 0, NULL, NULL),
                 "clEnqueueReadBuffer");
}

bool compute_collect(struct compute_device *d, const struct compute_buffer *b, void *data) {
    cl_int code;
    if (!d->is_cpu)
        return compute_read(d, b, 0, data, b->bytes);
    void *there = clEnqueueMapBuffer(d->queue, b->handle, CL_TRUE, CL_MAP_READ, 0, b->bytes, 0, NULL,
                                     NULL, &code);
    return check(code, "clEnqueueMapBuffer") &&
           check(clEnqueueUnmapMemObject(d->queue, b->handle, there, 0, NULL, NULL),
                 "clEnqueueUnmapMemObject") &&
           compute_wait(d);
}

bool compute_clear(struct compute_device *d, struct compute_buffer *b) {
    const cl_uchar zero = 0;
    return check(clEnqueueFillBuffer(d->queue, b->handle, &zero, 1, 0, b->bytes ? b->bytes : 1, 0,
                                     NULL, NULL), "clEnqueueFillBuffer");
}

// ---- kernels ------------------------------------------------------------------------------------

static void report_build(struct compute_device *d, cl_program program, const char *file) {
    char text[4096] = "";
    clGetProgramBuildInfo(program, d->id, CL_PROGRAM_BUILD_LOG, sizeof text - 1, text, NULL);
    log_error("OpenCL: kernels/%s.cl does not compile on %s: %s", file, d->name, text);
}

static cl_program build(struct compute_device *d, int file) {
    cl_int code;
    if (d->programs[file])
        return d->programs[file];
    const double start = time_seconds();
    const char *text = compute_sources[file].text;
    cl_program program = clCreateProgramWithSource(d->context, 1, &text, NULL, &code);
    if (!check(code, "clCreateProgramWithSource"))
        return NULL;
    if (clBuildProgram(program, 1, &d->id, "-cl-std=CL1.2", NULL, NULL) != CL_SUCCESS) {
        report_build(d, program, compute_sources[file].name);
        clReleaseProgram(program);
        return NULL;
    }
    d->build_seconds += time_seconds() - start;
    d->programs[file] = program;
    return program;
}

struct compute_kernel *compute_kernel(struct compute_device *d, const char *file, const char *name) {
    cl_int code;
    int index = 0;
    for (int i = 0; i < d->kernel_count; i++)
        if (strcmp(d->kernels[i].name, name) == 0)
            return &d->kernels[i];
    while (compute_sources[index].name && strcmp(compute_sources[index].name, file) != 0)
        index++;
    if (!compute_sources[index].name || index >= MOST_FILES || d->kernel_count == MOST_KERNELS) {
        log_error("OpenCL: there is no room for kernel %s of kernels/%s.cl", name, file);
        return NULL;
    }
    cl_program program = build(d, index);
    if (!program)
        return NULL;
    struct compute_kernel *k = &d->kernels[d->kernel_count];
    k->handle = clCreateKernel(program, name, &code);
    if (!check(code, "clCreateKernel"))
        return NULL;
    snprintf(k->name, sizeof k->name, "%s", name);
    d->kernel_count++;
    return k;
}

static cl_int set_arg(cl_kernel kernel, cl_uint i, const struct compute_arg *a) {
    cl_mem mem;
    switch (a->kind) {
    case COMPUTE_ARG_BUFFER:
        mem = a->buffer->handle;
        return clSetKernelArg(kernel, i, sizeof mem, &mem);
    case COMPUTE_ARG_UINT:
        return clSetKernelArg(kernel, i, sizeof(cl_uint), &a->u);
    case COMPUTE_ARG_FLOAT:
        break;
    }
    return clSetKernelArg(kernel, i, sizeof(cl_float), &a->f);
}

bool compute_run(struct compute_device *d, struct compute_kernel *k, size_t items,
                 const struct compute_arg *args, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (!check(set_arg(k->handle, i, &args[i]), "clSetKernelArg"))
            return false;
    const size_t local = 1;
    return items == 0 || check(clEnqueueNDRangeKernel(d->queue, k->handle, 1, NULL, &items, &local, 0,
                                                      NULL, NULL), "clEnqueueNDRangeKernel");
}

bool compute_wait(struct compute_device *d) {
    return check(clFinish(d->queue), "clFinish");
}
