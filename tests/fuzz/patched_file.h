#pragma once
// Files as a fuzzer gets deep into them: a sound one with bytes changed or its end cut off, or the input as
// the file.

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace seamwright {

class PatchedFile {
  public:
    // `make` writes the sound file at the path it is given.
    template <class Make>
    explicit PatchedFile(const std::string& name, const Make& make)
        : path_(folder() / (name + std::to_string(::getpid()))) {
        remove();
        make(path_);
        std::ifstream in(path_, std::ios::binary);
        sound_.assign(std::istreambuf_iterator<char>(in), {});
        if (sound_.empty()) std::abort();
    }
    ~PatchedFile() { remove(); }

    // First byte 0: patches of 4 bytes, offset (24 bits, little endian, modulo the length) and value. 1: the
    // same, the first offset being the length that is left. Else: all that follows is the file.
    const std::filesystem::path& with(const std::uint8_t* data, std::size_t size) {
        bytes_ = sound_;
        if (size > 0 && data[0] > 1) bytes_.assign(data + 1, data + size);
        for (std::size_t i = 1; size > 0 && data[0] <= 1 && i + 4 <= size; i += 4) {
            const std::size_t offset = data[i] | data[i + 1] << 8 | data[i + 2] << 16;
            if (data[0] == 1 && i == 1)
                bytes_.resize(offset % (sound_.size() + 1));
            else if (!bytes_.empty())
                bytes_[offset % bytes_.size()] = static_cast<char>(data[i + 3]);
        }
        remove();
        std::ofstream(path_, std::ios::binary)
            .write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
        return path_;
    }

  private:
    static std::filesystem::path folder() {
        return std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
    }
    void remove() const {
        for (const char* suffix : {"", "-journal", "-wal", "-shm"})
            std::filesystem::remove(path_.string() + suffix);
    }
    std::filesystem::path path_;
    std::vector<char> sound_, bytes_;
};

}  // namespace seamwright
