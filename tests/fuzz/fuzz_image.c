// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "fuzz.h"
#include "image/image.h"

static bool read_image(const char *path) {
    struct image im;
    if (!image_read(path, &im))
        return false;
    // every pixel must be there; what it holds is up to the file
    double sum = 0;
    const size_t n = (size_t)im.width * (size_t)im.height * (size_t)im.channels;
    for (size_t i = 0; i < n; i++)
        sum += im.pixels[i] == 0;
    if (im.width < 1 || im.height < 1 || im.channels < 1 || !(sum >= 0)) {
        fprintf(stderr, "%s: was read, but is empty\n", path);
        abort();
    }
    image_finish(&im);
    return true;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-image", read_image);
}
