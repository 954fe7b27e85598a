// SPDX-License-Identifier: BSD-3-Clause
// frames.c from C++: the context in a class that closes it, errors as exceptions.
//
//     frames-cpp [WIDTHxHEIGHT [FRAMES [LAST.ppm [BUDGET_MS]]]]
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include <hyperfocal/hyperfocal.h>

#include "scene.h"

namespace
{

class Defocus
{
  public:
    Defocus()
    {
        check(hf_open(&context_, nullptr));
    }
    ~Defocus()
    {
        hf_close(&context_);
    }
    Defocus(const Defocus &) = delete;
    Defocus &operator=(const Defocus &) = delete;

    // In place. Returns what the frame took.
    hf_report render(const hf_image &picture, const hf_depth &depth, const hf_params &params)
    {
        hf_report report = {};
        report.size = sizeof report;
        check(hf_render(context_, &picture, &picture, &depth, &params));
        hf_get_report(context_, &report);
        return report;
    }

  private:
    static void check(int error)
    {
        if (error)
            throw std::runtime_error(hf_error_string(error));
    }
    hf_context *context_ = nullptr;
};

struct FrameBuffer {
    FrameBuffer(int width, int height)
        : colour(4 * std::size_t(width) * std::size_t(height)),
          depth(std::size_t(width) * std::size_t(height)), view{width, height, colour.data(), depth.data()}
    {
    }
    hf_image image() const
    {
        hf_image m = {};
        m.size = sizeof m;
        m.width = view.width;
        m.height = view.height;
        m.format = HF_FORMAT_RGBX8;
        m.data[0] = view.colour;
        m.stride[0] = std::ptrdiff_t(view.width) * 4;
        m.transfer = HF_TRANSFER_SRGB;
        return m;
    }
    hf_depth window_depth() const
    {
        hf_depth d = {};
        d.size = sizeof d;
        d.data = view.depth + std::size_t(view.width) * std::size_t(view.height - 1);
        d.stride = -std::ptrdiff_t(view.width) * 4;
        d.type = HF_DEPTH_NDC_D3D;
        d.format = HF_DEPTH_FORMAT_UNORM32;
        d.near_plane = float(SCENE_NEAR);
        d.far_plane = float(SCENE_FAR);
        return d;
    }
    std::vector<std::uint8_t> colour;
    std::vector<std::uint32_t> depth;
    buffers view;
};

void render_frames(FrameBuffer &frame, int frames, float budget_ms)
{
    Defocus defocus;
    hf_params p = hf_default_params();
    p.model = HF_MODEL_LENS;
    p.focus = 6;
    p.lens.f_number = 0.7f;
    p.lens.world_unit_m = 0.25f;
    p.lens.focal_length_mm = scene_focal_mm(&frame.view);
    p.run.budget_ms = budget_ms;
    for (int i = 0; i < frames; i++) {
        draw_scene(&frame.view, i / 24.0);
        const hf_report r = defocus.render(frame.image(), frame.window_depth(), p);
        const double pixels = double(frame.view.width) * frame.view.height;
        std::printf("frame %3d: %.2f ms, blurred %.0f %%, budget step %d\n", i, r.total_ms,
                    100 * (1 - double(r.sharp_pixels) / pixels), r.budget_step);
    }
}

void write_ppm(const char *path, const buffers &b)
{
    std::ofstream file(path, std::ios::binary);
    file << "P6 " << b.width << ' ' << b.height << " 255\n";
    for (std::size_t i = 0; i < std::size_t(b.width) * std::size_t(b.height); i++)
        file.write(reinterpret_cast<const char *>(b.colour + 4 * i), 3);
    if (!file.flush())
        throw std::runtime_error(std::string(path) + " could not be written");
}

}  // namespace

int main(int argc, char **argv)
try {
    int width = 1280, height = 720;
    if (argc > 1 && (std::sscanf(argv[1], "%dx%d", &width, &height) != 2 || width < 1 || height < 1 || width > 8192 ||
                     height > 8192))
        throw std::runtime_error(std::string("the size \"") + argv[1] + "\" is not WIDTHxHEIGHT, 1 to 8192 each");
    FrameBuffer frame(width, height);
    const std::unique_ptr<osmesa_context, void (*)(OSMesaContext)> gl(
        OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, nullptr), OSMesaDestroyContext);
    if (!gl || !OSMesaMakeCurrent(gl.get(), frame.view.colour, GL_UNSIGNED_BYTE, width, height))
        throw std::runtime_error("Mesa could not be started");
    OSMesaPixelStore(OSMESA_Y_UP, 0);
    render_frames(frame, argc > 2 ? std::atoi(argv[2]) : 48, argc > 4 ? float(std::atof(argv[4])) : 16);
    if (argc > 3)
        write_ppm(argv[3], frame.view);
    return 0;
} catch (const std::exception &e) {
    std::fprintf(stderr, "frames-cpp: %s\n", e.what());
    return 1;
}
