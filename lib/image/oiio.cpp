// SPDX-License-Identifier: Apache-2.0
// The only C++ file: OpenImageIO has no C interface. Built as a module (oiio.h says why).
#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

extern "C" {
#include "image/display.h"
#include "image/oiio.h"
}

extern "C" oiio_module_decode_function oiio_module_decode;
extern "C" oiio_module_decode_function oiio_module_decode_voxels;
extern "C" oiio_module_decode_function oiio_module_display;
extern "C" oiio_module_write_png_function oiio_module_write_png;

static bool fail(struct decoder_input *in, const std::string &why) {
    std::snprintf(in->message, sizeof in->message, "%s",
                  why.empty() ? "it is damaged" : why.c_str());
    return false;
}

// 8-bit pictures and 16-bit PNG are in a display encoding unless the file itself says linear.
static bool is_srgb(const OIIO::ImageSpec &spec, const std::string &format) {
    const bool small = spec.format == OIIO::TypeDesc::UINT8;
    const bool wide_png = spec.format == OIIO::TypeDesc::UINT16 && format == "png";
    const bool linear = spec.get_string_attribute("oiio:ColorSpace") == "Linear";
    return (small || wide_png) && !linear;
}

// OpenImageIO chooses the decoder by the extension, which bytes in memory lack.
static const char *name_by_content(const struct decoder_input *in) {
    const auto *b = static_cast<const unsigned char *>(in->data);
    if (in->file_size > 2 && b[0] == 0xff && b[1] == 0xd8)
        return "embedded.jpg";
    if (in->file_size > 12 && std::memcmp(b + 8, "WEBP", 4) == 0)
        return "embedded.webp";
    return "embedded.png";
}

static bool decode(const struct oiio_host *host, struct decoder_input *in, struct image *im) {
    // The child has no threads but this one; libraries must not wait for others.
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    OIIO::ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1; // colour stays as it stands in the file
    OIIO::Filesystem::IOMemReader memory(const_cast<void *>(in->data), in->file_size);
    OIIO::Filesystem::IOProxy *proxy = &memory;
    if (in->data)
        config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    auto input = OIIO::ImageInput::open(in->data ? name_by_content(in) : in->path, &config);
    if (!input)
        return fail(in, OIIO::geterror());
    const OIIO::ImageSpec &spec = input->spec();
    if (spec.deep || spec.depth > 1)
        return fail(in, "is a deep or volume picture; expected a flat one");
    if (!host->init_image(in, im, spec.width, spec.height, spec.nchannels))
        return false;
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, im->pixels))
        return fail(in, input->geterror());
    for (int c = 0; c < im->channels && c < (int)spec.channelnames.size(); c++)
        std::snprintf(im->channel_names[c], IMAGE_NAME_SIZE, "%s", spec.channelnames[c].c_str());
    im->srgb_encoded = is_srgb(spec, input->format_name());
    im->bits = (int)spec.format.size() * 8;
    host->set_text(im, "file.format", input->format_name());
    return true;
}

extern "C" bool oiio_module_decode(const struct oiio_host *host, struct decoder_input *in,
                                   struct image *im) {
    try {
        return decode(host, in, im);
    } catch (const std::exception &e) {
        return fail(in, e.what());
    }
}

// Goes to the part of that name, else stays at the first.
static bool find_part(OIIO::ImageInput &input, const char *name) {
    for (int i = 0; name && input.seek_subimage(i, 0); i++)
        if (input.spec().get_string_attribute("oiio:subimagename") == name)
            return true;
    return !name;
}

// OpenImageIO's matrices are for rows of coordinates.
static std::string transposed(const OIIO::ImageSpec &spec, const char *name) {
    float m[16];
    std::string text;
    if (!spec.getattribute(name, OIIO::TypeDesc::TypeMatrix, m))
        return text;
    for (int i = 0; i < 16; i++)
        text += (i ? " " : "") + std::to_string((double)m[i % 4 * 4 + i / 4]);
    return text;
}

// Empty space costs such a file nothing, but a small one is not believed all that it claims.
static bool is_believed(struct decoder_input *in, const OIIO::ImageSpec &spec) {
    if (spec.depth < 1 || spec.depth > 1 << 16 || spec.height < 1 || spec.height > 1 << 16)
        return fail(in, "has an impossible size");
    const double mebibyte = 1 << 20, most = 64 * mebibyte + 256.0 * (double)in->file_size;
    if (4.0 * spec.width * spec.height * spec.depth * spec.nchannels <= most)
        return true;
    char text[200];
    std::snprintf(text, sizeof text,
                  "claims %d x %d x %d voxels; a file of %llu bytes may take at most %.0f MiB of "
                  "memory",
                  spec.width, spec.height, spec.depth, (unsigned long long)in->file_size,
                  most / mebibyte);
    return fail(in, text);
}

static bool decode_voxels(const struct oiio_host *host, struct decoder_input *in,
                          struct image *im) {
    OIIO::attribute("threads", 1);
    // By the format's name: `open` would try every other decoder on what this one refuses.
    auto input = OIIO::ImageInput::create("openvdb");
    OIIO::ImageSpec first;
    if (!input)
        return fail(in, OIIO::geterror());
    if (!input->open(in->path, first))
        return fail(in, input->geterror());
    if (!find_part(*input, in->part))
        return fail(in, std::string("has no grid \"") + in->part + "\"");
    const OIIO::ImageSpec spec = input->spec();
    if (spec.get_string_attribute("openvdb:class") == "level set")
        return fail(in, "is a level set, whose values are distances; expected a fog volume");
    if (!is_believed(in, spec) ||
        !host->init_image(in, im, spec.width, (int64_t)spec.height * spec.depth, spec.nchannels))
        return false;
    const int part = input->current_subimage();
    if (!input->read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, im->pixels))
        return fail(in, input->geterror());
    const std::string origin = std::to_string(spec.x) + " " + std::to_string(spec.y) + " " +
                               std::to_string(spec.z);
    host->set_text(im, "depth", std::to_string(spec.depth).c_str());
    host->set_text(im, "origin", origin.c_str());
    host->set_text(im, "indexToWorld", transposed(spec, "openvdb:indextoworld").c_str());
    return true;
}

extern "C" bool oiio_module_decode_voxels(const struct oiio_host *host, struct decoder_input *in,
                                          struct image *im) {
    try {
        return decode_voxels(host, in, im);
    } catch (const std::exception &e) {
        return fail(in, e.what());
    }
}

// ---- views of OpenColorIO -----------------------------------------------------------------------

using names = std::vector<std::string>;

static bool has(const names &all, const std::string &name) {
    return std::find(all.begin(), all.end(), name) != all.end();
}

static std::string quoted(const names &all) {
    std::string text;
    for (const std::string &name : all)
        text += (text.empty() ? "\"" : ", \"") + name + "\"";
    return text;
}

static bool absent(struct decoder_input *in, const std::string &what) {
    in->absent = true;
    return fail(in, what);
}

static std::string list_views(const OIIO::ColorConfig &config) {
    std::string text;
    for (const std::string &display : config.getDisplayNames())
        text += (text.empty() ? "\"" : "; \"") + display + "\" with the views " +
                quoted(config.getViewNames(display));
    return text;
}

// The default where none is asked for.
static bool find_view(struct decoder_input *in, const OIIO::ColorConfig &config,
                      const struct display_view *v, std::string &display, std::string &view) {
    const char *standard = config.getDefaultDisplayName();
    display = v->display ? v->display : standard ? standard : "";
    if (!has(config.getDisplayNames(), display))
        return absent(in, "has no display \"" + display + "\"; it has " + list_views(config));
    standard = config.getDefaultViewName(display);
    view = v->view ? v->view : standard ? standard : "";
    if (!has(config.getViewNames(display), view))
        return absent(in, "display \"" + display + "\" has no view \"" + view + "\"; there are " +
                              list_views(config));
    return true;
}

// The configuration's space of linear Rec.709 by one of the names that it goes by, else that of ACES
// by its role, with `aces` set.
static std::string find_linear(const OIIO::ColorConfig &config, bool &aces) {
    static const char *const known[] = {
        "Linear Rec.709 (sRGB)", "Linear Rec.709", "lin_rec709_srgb", "lin_rec709", "lin_srgb",
        "Utility - Linear - sRGB", "Utility - Linear - Rec.709"};
    names all = config.getColorSpaceNames();
    for (const std::string &space : names(all)) {
        const names aliases = config.getAliases(space);
        all.insert(all.end(), aliases.begin(), aliases.end());
    }
    for (const char *name : known)
        if (has(all, name))
            return name;
    const char *role = config.getColorSpaceNameByRole("aces_interchange");
    aces = role != nullptr;
    return role ? role : "";
}

static bool find_source(struct decoder_input *in, const OIIO::ColorConfig &config,
                        const struct display_view *v, std::string &space, bool &aces) {
    const std::string asked = v->from ? v->from : "";
    space = v->from ? asked : find_linear(config, aces);
    const char *role = v->from ? config.getColorSpaceNameByRole(asked) : nullptr;
    const std::string all = quoted(config.getColorSpaceNames());
    if (space.empty())
        return absent(in, "does not say which of its colour spaces is linear Rec.709; --from SPACE "
                          "does, of " + all);
    if (v->from && !role && !has(config.getColorSpaceNames(), asked) &&
        config.getAliases(asked).empty())
        return absent(in, "has no colour space or role \"" + asked + "\"; it has " + all);
    return true;
}

// No lookup table knows what to make of NaN, and none reaches beyond the range of half.
static void tame(struct image *im) {
    const size_t n = (size_t)im->width * (size_t)im->height * (size_t)im->channels;
    for (size_t i = 0; i < n; i++) {
        const float v = im->pixels[i];
        im->pixels[i] = std::isnan(v) ? 0 : std::max(-65504.0f, std::min(v, 65504.0f));
    }
}

static bool display_picture(const struct oiio_host *host, struct decoder_input *in,
                            struct image *im) {
    const auto *v = static_cast<const struct display_view *>(in->data);
    std::string display, view, space;
    bool aces = false;
    OIIO::attribute("threads", 1);
    const OIIO::ColorConfig config(v->config);
    if (config.has_error())
        return fail(in, const_cast<OIIO::ColorConfig &>(config).geterror());
    if (!find_view(in, config, v, display, view) || !find_source(in, config, v, space, aces))
        return false;
    const auto processor = config.createDisplayTransform(
        OIIO::string_view(display), OIIO::string_view(view), OIIO::string_view(space),
        OIIO::string_view());
    if (!processor)
        return fail(in, const_cast<OIIO::ColorConfig &>(config).geterror());
    const struct image *from = v->picture;
    if (!host->init_image(in, im, from->width, from->height, 3))
        return false;
    const size_t bytes = (size_t)im->width * (size_t)im->height * 3 * sizeof(float);
    std::memcpy(im->pixels, from->pixels, bytes);
    tame(im);
    if (aces)
        host->from_rec709(im, SPACE_ACES);
    processor->apply(im->pixels, im->width, im->height, 3, sizeof(float), 3 * sizeof(float),
                     3 * (OIIO::stride_t)im->width * (OIIO::stride_t)sizeof(float));
    im->srgb_encoded = true;
    return true;
}

extern "C" bool oiio_module_display(const struct oiio_host *host, struct decoder_input *in,
                                    struct image *im) {
    try {
        return display_picture(host, in, im);
    } catch (const std::exception &e) {
        return fail(in, e.what());
    }
}

// ---- PNG ----------------------------------------------------------------------------------------

// Whether all of it came to the disk: OpenImageIO's own writer does not say when that is full.
static bool write_file(const char *path, const std::vector<unsigned char> &bytes, std::string &why) {
    std::FILE *f = std::fopen(path, "wb");
    const bool written = f && std::fwrite(bytes.data(), 1, bytes.size(), f) == bytes.size();
    const bool closed = f && std::fclose(f) == 0;
    if (!written || !closed)
        why = std::strerror(errno);
    return written && closed;
}

static bool write_png(const char *path, const unsigned char *bytes, int width, int height,
                      int channels, bool srgb, std::string &why) {
    OIIO::attribute("threads", 1);
    auto output = OIIO::ImageOutput::create("png");
    if (!output) {
        why = OIIO::geterror();
        return false;
    }
    OIIO::Filesystem::IOVecOutput memory;
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
    if (srgb)
        spec["oiio:ColorSpace"] = "sRGB";
    const bool good = output->set_ioproxy(&memory) && output->open(path, spec) &&
                      output->write_image(OIIO::TypeDesc::UINT8, bytes) && output->close();
    if (!good)
        why = output->geterror();
    return good && write_file(path, memory.buffer(), why);
}

extern "C" bool oiio_module_write_png(const char *path, const unsigned char *bytes, int width,
                                      int height, int channels, bool srgb, char *message,
                                      size_t n) {
    std::string why;
    bool good = false;
    try {
        good = write_png(path, bytes, width, height, channels, srgb, why);
    } catch (const std::exception &e) {
        why = e.what();
    }
    std::snprintf(message, n, "%s", why.c_str());
    return good;
}
