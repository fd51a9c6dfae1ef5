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

// Looked up by their own text; a test compares them with what the layers below say.
[[maybe_unused]] constexpr auto kSentences = std::to_array<const char*>({
    QT_TRANSLATE_NOOP("Words", "The side on which the contour ends."),
    QT_TRANSLATE_NOOP(
        "Words",
        "Which end is meant where several lie in the window: the outermost on that side, that of the "
        "longest, the highest or the lowest contour, or the only one."),
    QT_TRANSLATE_NOOP("Words", "Outermost: the how-manyth end from outside."),
    QT_TRANSLATE_NOOP("Words",
                      "Left rim of the sensor's field, where profiles come without their empty lines."),
    QT_TRANSLATE_NOOP("Words",
                      "Right rim of the sensor's field, where profiles come without their empty lines."),
    QT_TRANSLATE_NOOP("Words", "Automatic split: which corner is meant where several lie in the window."),
    QT_TRANSLATE_NOOP("Words", "Shorter segments are passed over."),
    QT_TRANSLATE_NOOP("Words", "Length of contour before its end that says where the line goes."),
    QT_TRANSLATE_NOOP("Words",
                      "Where the left line ends and the right one begins: found, or given by two x ranges."),
    QT_TRANSLATE_NOOP("Words", "Given split: the left line's first x."),
    QT_TRANSLATE_NOOP("Words", "Given split: the left line's last x."),
    QT_TRANSLATE_NOOP("Words", "Given split: the right line's first x."),
    QT_TRANSLATE_NOOP("Words", "Given split: the right line's last x."),
    QT_TRANSLATE_NOOP("Words", "Automatic split: length of each line from the corner; 0 takes all."),
    QT_TRANSLATE_NOOP("Words", "Points nearer to the corner than this are left out: radius or burr."),
    QT_TRANSLATE_NOOP("Words", "Lines that meet at a smaller angle make no corner."),
    QT_TRANSLATE_NOOP("Words", "The radius when it is known; 0 fits it."),
    QT_TRANSLATE_NOOP("Words", "Free radius: the smallest that is accepted."),
    QT_TRANSLATE_NOOP("Words", "Free radius: the largest that is accepted."),
    QT_TRANSLATE_NOOP("Words", "The least arc that must be seen."),
    QT_TRANSLATE_NOOP("Words", "The extremum that is meant."),
    QT_TRANSLATE_NOOP("Words", "Length of contour around the extremum that the parabola takes."),
    QT_TRANSLATE_NOOP("Words", "Left limit of the search window."),
    QT_TRANSLATE_NOOP("Words", "Right limit of the search window."),
    QT_TRANSLATE_NOOP("Words", "Lower limit of the search window."),
    QT_TRANSLATE_NOOP("Words", "Upper limit of the search window."),
    QT_TRANSLATE_NOOP("Words", "How far along x the contour may have moved, +-."),
    QT_TRANSLATE_NOOP("Words", "How far along z the contour may have moved, +-."),
    QT_TRANSLATE_NOOP("Words", "How far the contour may have turned, +-."),
    QT_TRANSLATE_NOOP("Words", "Share of the template that must be seen."),
    QT_TRANSLATE_NOOP("Words", "Travel before the trigger, along the sensor's Y."),
    QT_TRANSLATE_NOOP("Words", "Travel after the trigger, along the sensor's Y."),
    QT_TRANSLATE_NOOP("Words", "Speed of the pass."),
    QT_TRANSLATE_NOOP("Words", "Standard deviation of a measured coordinate, with jitter."),
    QT_TRANSLATE_NOOP("Words", "Half width of the trigger jitter along the travel."),
    QT_TRANSLATE_NOOP("Words", "How much the sensor's X counts; 0 = not observed."),
    QT_TRANSLATE_NOOP("Words", "How much the travel direction Y counts; a profile does not see it."),
    QT_TRANSLATE_NOOP("Words", "How much the sensor's Z (height) counts; 0 = not observed."),
    QT_TRANSLATE_NOOP("Words", "Larger displacements are refused."),
    QT_TRANSLATE_NOOP("Words", "Larger turns are refused."),
    QT_TRANSLATE_NOOP("Words", "A correction less sure than this is not pushed."),
    QT_TRANSLATE_NOOP("Words", "A turn less sure than this is not pushed."),
    QT_TRANSLATE_NOOP("Words", "Exposure time."),
    QT_TRANSLATE_NOOP("Words", "Gain after exposure; 0 dB shows a full well as full scale."),
    QT_TRANSLATE_NOOP("Words", "Gain, as the camera calls it."),
    QT_TRANSLATE_NOOP("Words", "Laser on or off."),
    QT_TRANSLATE_NOOP("Words", "Frames a second when free running."),
    QT_TRANSLATE_NOOP("Words", "Frames per second; 0 replays as fast as frames are asked for."),
    QT_TRANSLATE_NOOP("Words", "First column of the image."),
    QT_TRANSLATE_NOOP("Words", "First row of the image."),
    QT_TRANSLATE_NOOP("Words", "Columns of the image."),
    QT_TRANSLATE_NOOP("Words", "Rows of the image."),
    QT_TRANSLATE_NOOP("Words", "How grey values or coordinates are coded."),
    QT_TRANSLATE_NOOP("Words", "What starts an exposure."),
    QT_TRANSLATE_NOOP("Words", "A car door before a stripe camera, rendered"),
    QT_TRANSLATE_NOOP("Words", "A panel in a gripper before a body's opening, rendered"),
    QT_TRANSLATE_NOOP("Words", "A robot whose gripper holds a panel"),
    QT_TRANSLATE_NOOP("Words", "A recorded capture, or profiles (CSV) or images of a folder, with poses"),
    QT_TRANSLATE_NOOP("Words", "GigE Vision and USB3 Vision cameras, images or profiles (GenICam)"),
    QT_TRANSLATE_NOOP("Words", "A robot with repeatability and trigger jitter"),
    QT_TRANSLATE_NOOP("Words", "KUKA, the controller connects by EthernetKRL"),
    QT_TRANSLATE_NOOP("Words", "KUKA, variables of the controller by KUKAVARPROXY"),
    QT_TRANSLATE_NOOP("Words", "KUKA path correction in every cycle (RSI)"),
    QT_TRANSLATE_NOOP("Words", "The poses and spots of a recorded capture or folder"),
    QT_TRANSLATE_NOOP("Words", "Universal Robots, registers and poses by RTDE"),
    QT_TRANSLATE_NOOP("Words", "ABB controller with our RAPID server task (TCP)"),
    QT_TRANSLATE_NOOP("Words", "ABB path correction in every cycle (EGM)"),
    QT_TRANSLATE_NOOP("Words", "LMI Gocator, profiles or the results of its own tools over TCP"),
    QT_TRANSLATE_NOOP("Words", "A point that the sensor's own tools have measured."),
    QT_TRANSLATE_NOOP("Words", "Which of the sensor's points, from 0."),
    QT_TRANSLATE_NOOP("Words", "Noise of each coordinate (1 sigma)."),
    QT_TRANSLATE_NOOP("Words", "Where the surface stops, seen from the left or the right."),
    QT_TRANSLATE_NOOP("Words", "The intersection of two lines fitted left and right of an edge."),
    QT_TRANSLATE_NOOP("Words", "The centre of a round piece of contour."),
    QT_TRANSLATE_NOOP("Words", "The highest, lowest, leftmost or rightmost place of the contour."),
    QT_TRANSLATE_NOOP("Words",
                      "A taught piece of contour found again; it carries its reference point along."),
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

QString shown_sentence(std::string_view english) {
    return QCoreApplication::translate("Words", std::string(english).c_str());
}

}  // namespace seamwright
