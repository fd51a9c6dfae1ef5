#pragma once
// Camera frames of a laser stripe, rendered from a mesh.
//
// Model. The laser is a fan from (0, 0, stand_off) of the sensor frame in the plane y = 0, of Gaussian
// thickness. The plane is cut with the mesh; every stretch of the cut is sampled at 0.35 px of the image, a
// sample is lit when nothing stands between it and the laser, and seen when nothing stands between it and the
// camera. Each seen sample adds a Gaussian spot to the image: along u the blur of the lens, along v blur and
// laser thickness together. So stripes are continuous, end softly at edges, and stand on steep walls as in a
// real camera.
//     light of a sample = exposure * (stand_off / distance) * (albedo * cos(incidence) + gloss * (r .
//     v)^shininess)
// Second bounce: the mirrored laser ray of glossy surface is followed to where it meets the part again, and
// that spot is drawn too. Stray reflections stand for shiny things that are no part of the mesh (clamps,
// fixture): a stretch of the stripe comes again, shifted, tilted, at 0.3 to 2 times its brightness. Dark
// patches scale the albedo (oil, sealer, paint). Electrons of a pixel: ambient + stripe with speckle (2 px
// grain), blooming along the column above 1.5 times full well, shot noise, read noise,
// then gain, offset, rounding and clipping to the bit depth. Not modelled: motion blur, colour, rolling
// shutter, more than one bounce, distortion of the laser line.
//
// The stripe's centre stands where SensorModel::to_pixel() puts the point: the model handed in is the truth
// that a perfect calibration would find.

#include <cstdint>
#include <span>
#include <vector>

#include "core/profile/sensor_model.h"
#include "devices/simulated/scene/mesh.h"

namespace seamwright {

struct OpticsSettings {
    int width = 1280, height = 1024, bit_depth = 8;
    double stand_off_mm = 300;      // laser to the middle of the measuring range, along Z
    double triangulation_deg = 30;  // between laser and camera, seen from there
    double field_mm = 100;          // of view along X in the middle of the range
    double k1 = -0.08, k2 = 0.05, p1 = 2e-4, p2 = -3e-4, k3 = 0;
    double laser_width_mm = 0.2;  // full width at half maximum
    double fan_deg = 30;          // full opening
    double blur_px = 0.8;         // sigma
    double blooming = 0.1;  // share of the charge above 1.5 times full well that runs out along the column
};
// Camera and laser plane of these optics. Camera: X along the sensor's X, at the laser's height, looking at
// the sensor's origin.
SensorModel sensor_model_of(const OpticsSettings& optics);

struct SurfaceSettings {
    double albedo = 0.5, gloss = 0.4, shininess = 30;
    double dark_share = 0.02;   // of the surface
    double dark_albedo = 0.06;  // there
    double dark_size_mm = 12;   // typical extent
    double mirror = 0.3;        // light kept by a second bounce; 0 = none
};

struct NoiseSettings {
    bool shot = true;
    double read_electrons = 25;
    double speckle = 0.2;  // contrast, 0 .. 0.5
    double ambient_electrons_per_ms = 120;
    double stray_probability = 0.15;  // of a frame to show stray reflections
};

inline constexpr double kFullWellElectrons = 10000;  // full scale at 0 dB
inline constexpr double kBrightElectronsPerMs =
    12000;  // of the stripe's middle on a white surface, facing the laser at stand-off

struct Exposure {
    double exposure_us = 1000, gain_db = 0;
    bool laser_on = true;    // off: what ambient light shows, as for a plate's board
    std::uint64_t seed = 0;  // of this frame: noise, speckle, stray reflections
};

// What is really seen, for tests and for judging extraction: the samples that were drawn, in no particular
// order.
struct StripeSample {
    float u_px, v_px;  // centre
    float x_mm, z_mm;  // sensor frame
    float electrons;   // of a level stripe's middle, before speckle and noise
    float length_px;   // stretch of the stripe that this sample stands for
    bool ghost;        // second bounce or stray; x, z are then those of the light's first landing
};

// Flat board under ambient light, beside the stripe (plate scene): squares of `pitch_mm`, columns x rows
// inner corners.
struct PlatePattern {
    int columns = 0, rows = 0;  // inner corners; 0 = none
    double pitch_mm = 10;
    double dark_albedo = 0.1;
};

// Keeps its buffers: rendering allocates nothing once warm. One thread at a time.
class StripeRenderer {
  public:
    StripeRenderer(const OpticsSettings& optics, const SurfaceSettings& surface, const NoiseSettings& noise);
    const SensorModel& model() const { return model_; }
    const OpticsSettings& optics() const { return optics_; }
    std::size_t image_bytes() const;

    // `pixels` has image_bytes(). `part_from_sensor` places the sensor before the mesh. Surface marks (dark
    // patches) belong to the part: `surface_seed` is the part's.
    void render(const MeshTree& part, const Pose& part_from_sensor, const Exposure& exposure,
                std::uint64_t surface_seed, std::span<std::byte> pixels,
                std::vector<StripeSample>* truth = nullptr, const PlatePattern& board = {});

  private:
    void trace(const MeshTree& part, const Pose& part_from_sensor, double scale, std::uint64_t surface_seed);
    void add_strays(std::uint64_t seed);
    void draw();
    void draw_board(const Pose& part_from_sensor, double electrons);
    void bloom_and_speckle(std::uint64_t seed);
    void expose(const Exposure& exposure, std::span<std::byte> pixels);
    double albedo_at(const Eigen::Vector3d& p_part, std::uint64_t seed) const;

    OpticsSettings optics_;
    SurfaceSettings surface_;
    NoiseSettings noise_;
    PlatePattern board_;
    SensorModel model_;
    Eigen::Vector3d laser_, camera_;  // in the sensor frame
    double sigma_u_, sigma_v_;        // px
    double dark_threshold_ = 2;       // of the surface noise
    std::size_t stride_;              // floats a row, padded for the vector units
    std::vector<float> electrons_;    // [height * stride]
    std::vector<float> ambient_;      // [height * stride] relative
    std::vector<StripeSample> samples_;
    struct Cut {
        Eigen::Vector3d a, b;  // sensor frame, a.x <= b.x
        int triangle;
    };
    std::vector<CutSegment> segments_;
    std::vector<Cut> cuts_;
    std::vector<std::pair<int, int>> rows_drawn_;  // per 16-column block: first and last row touched
    std::vector<std::size_t> hot_;
    std::vector<float> spill_;
    std::vector<Eigen::Vector2f> rays_;  // undistorted rays of all pixels, made at the first board
};

}  // namespace seamwright
