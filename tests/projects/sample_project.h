#pragma once
// A project that uses every field, and comparisons to the last bit.

#include <unistd.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "projects/file/project_json.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {

inline std::string file_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

class SampleMaker {
  public:
    explicit SampleMaker(unsigned seed) : rng_(seed) {}
    double number(double scale = 100) { return scale * normal_(rng_); }
    Pose pose() {
        return make_pose(rotation_exp(Eigen::Vector3d(number(1), number(1), number(1))),
                         Eigen::Vector3d(number(), number(), number()));
    }
    Profile profile(int points, bool columns = true) {
        Profile p;
        for (int i = 0; i < points; ++i) {
            p.x_mm.push_back(number());
            p.z_mm.push_back(i % 17 == 3 ? std::numeric_limits<double>::quiet_NaN() : number());
            if (columns) {
                p.intensity.push_back(static_cast<float>(number()));
                p.segment.push_back(i % 5 ? i / 10 : kOutlier);
            }
        }
        return p;
    }
    Capture image_capture(const std::string& spot, int lines) {
        Capture c;
        c.spot_id = spot;
        c.sensor_id = "A";
        c.sequence = rng_();
        c.device_time_ns = -static_cast<std::int64_t>(rng_());
        c.host_time_ns = static_cast<std::int64_t>(rng_());
        c.base_from_flange = pose();
        ProfileCandidates& k = c.candidates;
        k.lines = lines;
        k.per_line = 3;
        const auto n = static_cast<std::size_t>(lines) * 3;
        k.count.assign(static_cast<std::size_t>(lines), 0);
        k.x_mm.assign(n, 0.0);
        k.z_mm.assign(n, 0.0);
        k.intensity.assign(n, 0.0f);
        for (int line = 0; line < lines; ++line) {
            k.count[static_cast<std::size_t>(line)] = static_cast<std::uint8_t>(rng_() % 4);
            for (int i = 0; i < k.count[static_cast<std::size_t>(line)]; ++i) {
                const auto at = static_cast<std::size_t>(k.index(line, i));
                k.x_mm[at] = number();
                k.z_mm[at] = number();
                k.intensity[at] = static_cast<float>(number());
            }
        }
        return c;
    }
    std::mt19937& rng() { return rng_; }

  private:
    std::mt19937 rng_;
    std::normal_distribution<double> normal_;
};

Project sample_project(unsigned seed = 1);
RunRecord sample_run(unsigned seed, int captures = 4, int points = 300);
PanelRecord sample_panel_record(unsigned seed);
inline constexpr int kSampleEvidence = 7;  // kinds
Evidence sample_evidence(int kind);

// Equality to the last bit, NaN equal to itself, through the complete and exact JSON form.
template <class T>
std::string exact_text(const T& value) {
    return to_json_document(value, {.profiles = true, .rigid_poses = false}).dump(1);
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b);
bool same_bits(const Profile& a, const Profile& b);
bool same_bits(const Capture& a, const Capture& b);

}  // namespace seamwright
