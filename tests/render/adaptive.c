// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling has no bias: the mean of many short adaptive pictures is the picture. And it does
// what it is for: samples go where the noise is.
#include "render/picture.h"

enum { WIDTH = 24, HEIGHT = 16, SIDE = 8, BLOCKS = WIDTH * HEIGHT / SIDE / SIDE, RENDERS = 200 };

// A lamp that few paths find beside a sky that all of them see: fixed sample counts that followed what
// they had found would be far off here.
static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'/>"
    "<sensor type='perspective'><float name='fov' value='60'/><transform name='to_world'>"
    "<lookat origin='0,1,4' target='0,0.7,0' up='0,1,0'/></transform><sampler type='%s'/>"
    "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='16'/>"
    "<rfilter type='box'/></film></sensor>"
    "<emitter type='constant'><rgb name='radiance' value='0.2'/></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<rotate x='1' angle='-90'/></transform></shape>"
    "<shape type='sphere'><point name='center' x='0' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughconductor'><float name='alpha' value='0.05'/>"
    "</bsdf></shape><shape type='sphere'><point name='center' x='-1' y='2' z='0'/>"
    "<float name='radius' value='0.1'/><emitter type='area'><rgb name='radiance' value='60'/>"
    "</emitter></shape></scene>";

// A small thing before a plain sky, whose noise has its place.
static const char small[] =
    "<scene version='3.0.0'><integrator type='path'/>"
    "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
    "<lookat origin='0,1,9' target='0,1,0' up='0,1,0'/></transform><sampler type='sobol'/>"
    "<film type='hdrfilm'><integer name='width' value='80'/><integer name='height' value='48'/>"
    "<rfilter type='box'/></film></sensor>"
    "<emitter type='constant'><rgb name='radiance' value='0.3'/></emitter>"
    "<shape type='sphere'><point name='center' x='0' y='0.9' z='0'/>"
    "<float name='radius' value='0.4'/><bsdf type='roughconductor'><float name='alpha' value='0.2'/>"
    "</bsdf></shape><shape type='rectangle'><transform name='to_world'><scale value='0.6'/>"
    "<rotate x='1' angle='-90'/><translate y='0.5'/></transform></shape>"
    "<shape type='sphere'><point name='center' x='2' y='4' z='2'/><float name='radius' value='0.2'/>"
    "<emitter type='area'><rgb name='radiance' value='100'/></emitter></shape></scene>";

// Means of the red channel over 8x8 blocks.
static void block_means(const struct image *im, double means[BLOCKS]) {
    for (int b = 0; b < BLOCKS; b++) {
        const int x0 = b % (WIDTH / SIDE) * SIDE, y0 = b / (WIDTH / SIDE) * SIDE;
        means[b] = 0;
        for (int i = 0; i < SIDE * SIDE; i++)
            means[b] += (double)pixel_at(im, x0 + i % SIDE, y0 + i / SIDE)[0] / (SIDE * SIDE);
    }
}

struct spread {
    double sum[BLOCKS], squares[BLOCKS];
};

static void add(struct spread *s, const double means[BLOCKS]) {
    for (int b = 0; b < BLOCKS; b++) {
        s->sum[b] += means[b];
        s->squares[b] += means[b] * means[b];
    }
}

static void render_many(const char *text, const struct job_options *options, int renders,
                        uint32_t first_seed, struct spread *s) {
    for (int i = 0; i < renders; i++) {
        struct job_options o = *options;
        struct render_result result;
        struct image im;
        double means[BLOCKS];
        o.seed = first_seed + (uint32_t)i;
        render_text(text, &o, &im, &result);
        block_means(&im, means);
        add(s, means);
        image_finish(&im);
    }
}

// The difference of two means of blocks in standard errors, both from the spread of their renders.
// Six blocks: the largest |z| is below 4.2 but for 1.6 in 10 000 runs; that of the sum of squares of
// 199 degrees of freedom is close to normal.
static void the_mean_is_the_picture(const char *sampler) {
    enum { PLAIN = 50 };
    struct spread adaptive = {0}, plain = {0};
    char text[4096];
    double worst = 0;
    snprintf(text, sizeof text, scene, sampler);
    render_many(text, &(struct job_options){.spp = 16, .adaptive = true}, RENDERS, 1, &adaptive);
    render_many(text, &(struct job_options){.spp = 256}, PLAIN, 1000, &plain);
    for (int b = 0; b < BLOCKS; b++) {
        const double m = adaptive.sum[b] / RENDERS, n = plain.sum[b] / PLAIN;
        const double v = (adaptive.squares[b] / RENDERS - m * m) / (RENDERS - 1) +
                         (plain.squares[b] / PLAIN - n * n) / (PLAIN - 1);
        const double floor = 1e-12; // squared: a block that sees the sky only is the same always
        const double z = (m - n) / sqrt(v + floor);
        printf("%s: block %d: adaptive %.5f, plain %.5f, z %.2f\n", sampler, b, m, n, z);
        worst = fmax(worst, fabs(z));
    }
    CHECK(worst < 4.2);
}

// A quarter at least is spread evenly.
static void samples_go_where_noise_is(void) {
    struct render_result result;
    struct image im;
    double sum = 0, least = 1e9, most = 0;
    render_text(small, &(struct job_options){.spp = 64, .adaptive = true}, &im, &result);
    const int c = image_find_channel(&im, "samples.Y"), pixels = im.width * im.height;
    CHECK(c >= 0);
    for (int i = 0; i < pixels; i++) {
        const double n = (double)im.pixels[i * im.channels + c];
        sum += n / pixels;
        least = fmin(least, n);
        most = fmax(most, n);
    }
    printf("samples: %.0f to %.0f, %.1f in the mean\n", least, most, sum);
    CHECK(sum > 58 && sum < 72 && least == 16 && most > 256);
    CHECK(result.paths == (uint64_t)(sum * pixels + 0.5));
    image_finish(&im);
}

int main(void) {
    scene_folder_open();
    log_set_level(LOG_WARN);
    the_mean_is_the_picture("sobol");
    the_mean_is_the_picture("independent");
    samples_go_where_noise_is();
    scene_folder_close();
    return check_result();
}
