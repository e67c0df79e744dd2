// SPDX-License-Identifier: Apache-2.0
// Cryptomatte: the hash against published values, names, and coverage against the alpha channel.
#include "driver/cryptomatte.h"
#include "math/murmur.h"
#include "render/picture.h"

static const char scene[] =
    "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/>"
    "<transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='16'/>"
    "<string name='pixel_format' value='rgba'/></film></sensor><emitter type='constant'/>"
    "<shape type='sphere' id='ball'><point name='center' x='-1' y='0' z='0'/></shape>"
    "<shape type='shapegroup' id='g'><shape type='sphere' id='part'><float name='radius' value='0.8'/>"
    "<bsdf type='mask' id='veil'><float name='opacity' value='0.5'/><bsdf type='diffuse'/></bsdf>"
    "</shape></shape><shape type='instance' id='copy'><ref id='g'/>"
    "<transform name='to_world'><translate x='1'/></transform></shape></scene>";

static float id_of(uint32_t hash) {
    float id;
    memcpy(&id, &hash, sizeof id);
    return id;
}

// Sum over the ranks of a layer, of one name or (0) of all.
static double coverage(const struct image *im, const float *pixel, const char *layer, float id) {
    double sum = 0;
    for (int r = 0; r < 6; r++) {
        char name[64];
        snprintf(name, sizeof name, "%s%02d.%c", layer, r / 2, r % 2 ? 'B' : 'R');
        const int c = image_find_channel(im, name);
        snprintf(name, sizeof name, "%s%02d.%c", layer, r / 2, r % 2 ? 'A' : 'G');
        const int w = image_find_channel(im, name);
        CHECK(c >= 0 && w >= 0);
        if (c >= 0 && w >= 0 && (id == 0 || pixel[c] == id))
            sum += (double)pixel[w];
    }
    return sum;
}

static void covers_what_is_seen(void) {
    struct render_result result;
    struct image im;
    double ball = 0, copy = 0, worst = 0;
    const float ball_id = id_of(murmur3_32("ball", 4)), copy_id = id_of(murmur3_32("copy", 4));
    render_text(scene, &(struct job_options){.spp = 64, .cryptomatte = "object,material"}, &im,
                &result);
    const int alpha = image_find_channel(&im, "A");
    for (int y = 0; y < im.height; y++)
        for (int x = 0; x < im.width; x++) {
            const float *p = pixel_at(&im, x, y);
            worst = fmax(worst, fabs(coverage(&im, p, "CryptoObject", 0) - (double)p[alpha]));
            worst = fmax(worst, fabs(coverage(&im, p, "CryptoMaterial", 0) - (double)p[alpha]));
            ball += coverage(&im, p, "CryptoObject", ball_id);
            copy += coverage(&im, p, "CryptoObject", copy_id);
        }
    printf("coverage and alpha differ by %g; ball %g, copy %g pixels\n", worst, ball, copy);
    CHECK(worst < 1e-6); // the picture's own samples
    // Smaller, and seen by half of the rays in front and half of the rest behind: 0.8^2 3/4.
    CHECK(ball > 20 && copy > 0.4 * ball && copy < 0.6 * ball);
    const struct image_attribute *manifest = image_find_attribute(&im, "cryptomatte/3ae39a5/manifest");
    CHECK(manifest && strstr(manifest->text, "\"ball\": \"") && strstr(manifest->text, "\"copy\""));
    image_finish(&im);
}

int main(void) {
    CHECK(murmur3_32("", 0) == 0);
    CHECK(murmur3_32("hello", 5) == 0x248bfa47u);
    CHECK(murmur3_32("hello, world", 12) == 0x149bbb7fu);
    CHECK(murmur3_32("The quick brown fox jumps over the lazy dog", 43) == 0x2e4ff723u);
    scene_folder_open();
    covers_what_is_seen();
    scene_folder_close();
    return check_result();
}
