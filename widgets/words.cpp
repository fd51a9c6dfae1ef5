#include "widgets/words.h"

#include <QCoreApplication>
#include <algorithm>
#include <array>

namespace seamwright {
namespace {

struct Word {
    std::string_view identifier;
    const char* text;
};

constexpr auto kWords = std::to_array<Word>({
    // settings of features
    {"side", QT_TRANSLATE_NOOP("Words", "Side")},
    {"segment", QT_TRANSLATE_NOOP("Words", "Segment")},
    {"order", QT_TRANSLATE_NOOP("Words", "Counted from outside")},
    {"minimum_points", QT_TRANSLATE_NOOP("Words", "Least points")},
    {"fit_length_mm", QT_TRANSLATE_NOOP("Words", "Fitted length")},
    {"field_x_min_mm", QT_TRANSLATE_NOOP("Words", "Sensor's field, x from")},
    {"field_x_max_mm", QT_TRANSLATE_NOOP("Words", "Sensor's field, x to")},
    {"split", QT_TRANSLATE_NOOP("Words", "Split")},
    {"left_from_mm", QT_TRANSLATE_NOOP("Words", "Left line, x from")},
    {"left_to_mm", QT_TRANSLATE_NOOP("Words", "Left line, x to")},
    {"right_from_mm", QT_TRANSLATE_NOOP("Words", "Right line, x from")},
    {"right_to_mm", QT_TRANSLATE_NOOP("Words", "Right line, x to")},
    {"side_length_mm", QT_TRANSLATE_NOOP("Words", "Length of lines")},
    {"blend_mm", QT_TRANSLATE_NOOP("Words", "Blend left out")},
    {"minimum_angle_deg", QT_TRANSLATE_NOOP("Words", "Least angle")},
    {"radius_mm", QT_TRANSLATE_NOOP("Words", "Radius")},
    {"radius_min_mm", QT_TRANSLATE_NOOP("Words", "Least radius")},
    {"radius_max_mm", QT_TRANSLATE_NOOP("Words", "Largest radius")},
    {"minimum_arc_deg", QT_TRANSLATE_NOOP("Words", "Least arc")},
    {"which", QT_TRANSLATE_NOOP("Words", "Which one")},
    {"index", QT_TRANSLATE_NOOP("Words", "Number")},
    {"window_x_min_mm", QT_TRANSLATE_NOOP("Words", "Window, x from")},
    {"window_x_max_mm", QT_TRANSLATE_NOOP("Words", "Window, x to")},
    {"window_z_min_mm", QT_TRANSLATE_NOOP("Words", "Window, z from")},
    {"window_z_max_mm", QT_TRANSLATE_NOOP("Words", "Window, z to")},
    {"window_dx_mm", QT_TRANSLATE_NOOP("Words", "Search along x")},
    {"window_dz_mm", QT_TRANSLATE_NOOP("Words", "Search along z")},
    {"window_dphi_deg", QT_TRANSLATE_NOOP("Words", "Search in angle")},
    {"minimum_share", QT_TRANSLATE_NOOP("Words", "Least share seen")},
    // of spots and regions
    {"entry_mm", QT_TRANSLATE_NOOP("Words", "Entry")},
    {"exit_mm", QT_TRANSLATE_NOOP("Words", "Exit")},
    {"speed_mm_s", QT_TRANSLATE_NOOP("Words", "Speed")},
    {"sigma_mm", QT_TRANSLATE_NOOP("Words", "Sigma")},
    {"jitter_mm", QT_TRANSLATE_NOOP("Words", "Trigger jitter")},
    {"weight_x", QT_TRANSLATE_NOOP("Words", "Weight of X")},
    {"weight_y", QT_TRANSLATE_NOOP("Words", "Weight of Y")},
    {"weight_z", QT_TRANSLATE_NOOP("Words", "Weight of Z")},
    {"limit_translation_mm", QT_TRANSLATE_NOOP("Words", "Largest shift")},
    {"limit_rotation_deg", QT_TRANSLATE_NOOP("Words", "Largest turn")},
    {"sigma_limit_mm", QT_TRANSLATE_NOOP("Words", "Largest sigma, shift")},
    {"sigma_limit_deg", QT_TRANSLATE_NOOP("Words", "Largest sigma, turn")},
    // of sensors
    {"exposure_us", QT_TRANSLATE_NOOP("Words", "Exposure")},
    {"gain_db", QT_TRANSLATE_NOOP("Words", "Gain")},
    {"laser", QT_TRANSLATE_NOOP("Words", "Laser")},
    {"frame_rate_hz", QT_TRANSLATE_NOOP("Words", "Frame rate")},
    {"rate_hz", QT_TRANSLATE_NOOP("Words", "Rate")},
    {"region_x", QT_TRANSLATE_NOOP("Words", "Image region, x")},
    {"region_y", QT_TRANSLATE_NOOP("Words", "Image region, y")},
    {"region_width", QT_TRANSLATE_NOOP("Words", "Image region, width")},
    {"region_height", QT_TRANSLATE_NOOP("Words", "Image region, height")},
    {"pixel_format", QT_TRANSLATE_NOOP("Words", "Pixel format")},
    {"trigger", QT_TRANSLATE_NOOP("Words", "Trigger")},
    // units that are words
    {"deg", QT_TRANSLATE_NOOP("Words", "deg")},
    {"us", QT_TRANSLATE_NOOP("Words", "us")},
    // choices
    {"chessboard", QT_TRANSLATE_NOOP("Words", "chessboard")},
    {"circles", QT_TRANSLATE_NOOP("Words", "circles")},
    {"charuco", QT_TRANSLATE_NOOP("Words", "ChArUco")},
    {"aprilgrid", QT_TRANSLATE_NOOP("Words", "AprilGrid")},
    {"found", QT_TRANSLATE_NOOP("Words", "found")},
    {"yes", QT_TRANSLATE_NOOP("Words", "yes")},
    {"no", QT_TRANSLATE_NOOP("Words", "no")},
    {"left", QT_TRANSLATE_NOOP("Words", "left")},
    {"right", QT_TRANSLATE_NOOP("Words", "right")},
    {"outermost", QT_TRANSLATE_NOOP("Words", "outermost")},
    {"longest", QT_TRANSLATE_NOOP("Words", "longest")},
    {"highest", QT_TRANSLATE_NOOP("Words", "highest")},
    {"lowest", QT_TRANSLATE_NOOP("Words", "lowest")},
    {"leftmost", QT_TRANSLATE_NOOP("Words", "leftmost")},
    {"rightmost", QT_TRANSLATE_NOOP("Words", "rightmost")},
    {"only", QT_TRANSLATE_NOOP("Words", "the only one")},
    {"sharpest", QT_TRANSLATE_NOOP("Words", "sharpest")},
    {"automatic", QT_TRANSLATE_NOOP("Words", "automatic")},
    {"given", QT_TRANSLATE_NOOP("Words", "given")},
    {"off", QT_TRANSLATE_NOOP("Words", "off")},
    {"on", QT_TRANSLATE_NOOP("Words", "on")},
    {"free", QT_TRANSLATE_NOOP("Words", "free running")},
    {"software", QT_TRANSLATE_NOOP("Words", "by software")},
    // kinds of feature
    {"contour-end", QT_TRANSLATE_NOOP("Words", "contour end")},
    {"corner", QT_TRANSLATE_NOOP("Words", "corner")},
    {"circle", QT_TRANSLATE_NOOP("Words", "circle")},
    {"extremum", QT_TRANSLATE_NOOP("Words", "extremum")},
    {"template", QT_TRANSLATE_NOOP("Words", "template")},
    {"sensor-point", QT_TRANSLATE_NOOP("Words", "sensor's own point")},
    // states
    {"ok", QT_TRANSLATE_NOOP("Words", "ok")},
    {"no_points", QT_TRANSLATE_NOOP("Words", "no points")},
    {"not_found", QT_TRANSLATE_NOOP("Words", "not found")},
    {"ambiguous", QT_TRANSLATE_NOOP("Words", "ambiguous")},
    {"ill_conditioned", QT_TRANSLATE_NOOP("Words", "ill-conditioned")},
    {"measured", QT_TRANSLATE_NOOP("Words", "measured")},
    {"not_measured", QT_TRANSLATE_NOOP("Words", "not measured")},
    {"damaged_frame", QT_TRANSLATE_NOOP("Words", "damaged frame")},
    {"no_stripe", QT_TRANSLATE_NOOP("Words", "no stripe")},
    {"no_calibration", QT_TRANSLATE_NOOP("Words", "no calibration")},
    {"no_feature", QT_TRANSLATE_NOOP("Words", "no feature")},
    {"not_pushed", QT_TRANSLATE_NOOP("Words", "not pushed")},
    {"written", QT_TRANSLATE_NOOP("Words", "written, read back")},
    {"failed", QT_TRANSLATE_NOOP("Words", "failed")},
    {"restored", QT_TRANSLATE_NOOP("Words", "old frame restored")},
    {"not_restored", QT_TRANSLATE_NOOP("Words", "NOT RESTORED")},
    {"under_determined", QT_TRANSLATE_NOOP("Words", "under-determined")},
    {"over_limit", QT_TRANSLATE_NOOP("Words", "over limit")},
    {"not_converged", QT_TRANSLATE_NOOP("Words", "not converged")},
    {"unknown", QT_TRANSLATE_NOOP("Words", "unknown")},
    {"manual_reduced", QT_TRANSLATE_NOOP("Words", "manual, reduced (T1)")},
    {"manual_full", QT_TRANSLATE_NOOP("Words", "manual, full speed (T2)")},
    {"external", QT_TRANSLATE_NOOP("Words", "external")},
    {"stopped", QT_TRANSLATE_NOOP("Words", "stopped")},
    {"fault", QT_TRANSLATE_NOOP("Words", "fault")},
    // verdicts of calibrations
    {"good", QT_TRANSLATE_NOOP("Words", "good")},
    {"usable", QT_TRANSLATE_NOOP("Words", "usable")},
    {"bad", QT_TRANSLATE_NOOP("Words", "bad")},
});

const Word* find(std::string_view identifier) {
    const auto at =
        std::find_if(kWords.begin(), kWords.end(), [&](const Word& w) { return w.identifier == identifier; });
    return at == kWords.end() ? nullptr : &*at;
}

}  // namespace

bool has_word(std::string_view identifier) {
    return find(identifier) != nullptr;
}

QString shown_word(std::string_view identifier) {
    if (const Word* word = find(identifier)) return QCoreApplication::translate("Words", word->text);
    return QString::fromUtf8(identifier.data(), static_cast<qsizetype>(identifier.size())).replace('_', ' ');
}

}  // namespace seamwright
