// SPDX-License-Identifier: BSD-3-Clause
// OpenImageIO's readers and writers for the helper program's C++: they open what may be opened, keep exceptions in and turn
// failures into our errors.
#ifndef HF_IO_OIIO_STREAMS_HPP
#define HF_IO_OIIO_STREAMS_HPP

#include "tools/io/oiio/oiio.h"

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

inline int source = -1;  // descriptor of the file that this process reads

// By what name to open it: by its own, whose end says the format, unless that is another file's by now.
inline std::string name_of(const char *path)
{
    struct stat named, opened;
    const bool same = !stat(path, &named) && !fstat(source, &opened) && named.st_dev == opened.st_dev &&
                      named.st_ino == opened.st_ino;
    return same || source < 0 ? path : "/proc/self/fd/" + std::to_string(source);
}

// Runs body, which returns 0 or -1; exceptions become an error like any other.
template <class Body> int guarded(const char *path, hf_io_error *err, Body body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return hf_io_fail(err, "%s: out of memory", path);
    } catch (const std::exception &e) {
        return hf_io_fail(err, "%s: %s", path, e.what());
    } catch (...) {
        return hf_io_fail(err, "%s: OpenImageIO failed", path);
    }
}

inline std::string why(std::string message)
{
    while (!message.empty() && std::isspace((unsigned char)message.back()))
        message.pop_back();
    return message.empty() ? "OpenImageIO gives no reason" : message;
}

// OpenImageIO prints errors that nobody asked for when the reader goes, so every reader goes through here.
struct Input {
    std::unique_ptr<ImageInput> in;

    ~Input()
    {
        if (in)
            in->geterror();
        OIIO::geterror();
    }

    int fail(const char *path, hf_io_error *err)
    {
        const std::string message = in && in->has_error() ? in->geterror() : OIIO::geterror();
        if (message.find("could not find a format reader") != std::string::npos)
            return hf_io_fail(err, "%s: not a picture of any kind that can be read here", path);
        return hf_io_fail(err, "%s: truncated or corrupt, or no picture: %s", path, why(message).c_str());
    }
};

// A writer into memory: what goes wrong on a disk is then the program's business, who looks at what write() returns.
// Formats that insist on a file of their own get one in memory, and are read back, as they do not look either.
struct Output {
    const char *path;
    hf_io_error *err;
    OIIO::Filesystem::IOVecOutput memory;
    std::unique_ptr<ImageOutput> out;
    int file = -1;
    char name[64] = "";

    Output(const char *p, hf_io_error *e, const std::string &format) : path(p), err(e), out(ImageOutput::create(format))
    {
    }

    ~Output()
    {
        if (out)
            out->geterror();
        OIIO::geterror();
        if (file >= 0)
            ::close(file);
    }

    int fail()
    {
        const std::string message = out && out->has_error() ? out->geterror() : OIIO::geterror();
        return hf_io_fail(err, "%s: cannot write: %s", path, why(message).c_str());
    }

    int open(const ImageSpec &spec)
    {
        if (!out)
            return fail();
        if (out->supports("ioproxy")) {
            out->set_ioproxy(&memory);
        } else {
            file = memfd_create("picture", MFD_CLOEXEC);
            snprintf(name, sizeof(name), "/proc/self/fd/%d", file);
        }
        return out->open(file >= 0 ? name : path, spec) ? 0 : fail();
    }

    int read_back(const ImageSpec &spec)
    {
        Input input;
        input.in = ImageInput::create(out->format_name());
        ImageSpec found;
        if (!input.in || !input.in->open(name, found))
            return input.fail(path, err);
        std::vector<float> pixels((size_t)found.width * (size_t)found.height * (size_t)found.nchannels);
        if (found.width != spec.width || found.height != spec.height || found.nchannels != spec.nchannels)
            return hf_io_fail(err, "%s: cannot write: the format holds another picture than it was given", path);
        return input.in->read_image(0, 0, 0, found.nchannels, TypeDesc::FLOAT, pixels.data()) ? 0
                                                                                              : input.fail(path, err);
    }

    int write(TypeDesc type, const void *pixels, hf_io_bytes *made)
    {
        const ImageSpec spec = out->spec();
        struct stat st;
        if (!out->write_image(type, pixels) || !out->close())
            return fail();
        if (file >= 0 && (read_back(spec) || fstat(file, &st)))
            return -1;
        made->size = file >= 0 ? (size_t)st.st_size : memory.buffer().size();
        made->data = made->size ? (uint8_t *)malloc(made->size) : nullptr;
        if (!made->data)
            return hf_io_fail(err, "%s: cannot write: %s", path, made->size ? "out of memory" : "nothing was written");
        if (file < 0)
            memcpy(made->data, memory.buffer().data(), made->size);
        else if (pread(file, made->data, made->size, 0) != (ssize_t)made->size)
            return hf_io_fail(err, "%s: cannot write: the format's writer lost its file", path);
        return 0;
    }
};

inline int find_channel(const ImageSpec &spec, const char *name)
{
    for (int c = 0; c < spec.nchannels; c++)
        if (spec.channel_name(c) == name)
            return c;
    return -1;
}

#endif
