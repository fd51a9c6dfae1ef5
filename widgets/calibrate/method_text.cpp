#include "widgets/calibrate/method_text.h"

#include <QCoreApplication>

namespace seamwright {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(MethodText)
  public:
    static MethodText of(const QString& id) {
        if (id == "tcp-sphere")
            return {tr("Sensor on the flange (sphere)"),
                    tr("Finds where the sensor sits on the flange, from cuts through one fixed sphere."),
                    {tr("A matt sphere of known radius on a stiff post that nobody touches."),
                     tr("Camera and laser plane calibrated: the profile must be in millimetres."),
                     tr("9 or more poses: the stripe off the middle to both sides, the sensor turned about "
                        "all three "
                        "axes by 20 degrees and more.")},
                    tr("JSON with radius, robot poses and profiles")};
        if (id == "stripe-camera")
            return {
                tr("Camera and laser plane (board)"),
                tr("Finds lens, laser plane and, with robot poses, the place on the flange, from one board."),
                {tr("A flat chessboard, its corners counted and its pitch known."),
                 tr("10 or more pictures with the stripe across the board, tilted to both sides about both "
                    "axes, at "
                    "different heights, out to the corners of the picture."),
                 tr("The board stays where it is; only the robot moves.")},
                tr("folder of images with pose files")};
        if (id == "hand-eye")
            return {tr("Camera on the flange (hand-eye)"),
                    tr("Finds where the camera sits on the flange, from views of one fixed board."),
                    {tr("A flat chessboard that stays where it is."),
                     tr("A calibrated camera: the board's place in the picture must be right."),
                     tr("8 or more poses turned about at least two axes.")},
                    tr("JSON with pairs of poses, or a folder of images with pose files")};
        if (id == "laser-plane")
            return {tr("Laser plane (triangular body)"),
                    tr("Finds the laser plane in a known camera, from the apex of a triangular body."),
                    {tr("A triangular body square to the sensor, its apex seen in the picture."),
                     tr("A sensor that gives profiles in millimetres; or the robot as the stage: it shifts "
                        "the sensor along its own X and Z alone and never turns it."),
                     tr("10 or more positions spread over the field, not on one line.")},
                    tr("JSON with pairs of pixel and laser point")};
        if (id == "lut")
            return {tr("Look-up table"),
                    tr("Maps pixels to millimetres directly, from a target at known places."),
                    {tr("A triangular body square to the sensor, and the robot that shifts the sensor along "
                        "its own X "
                        "and Z alone; or pairs measured on a stage, from a file."),
                     tr("25 or more places over the whole field; what lies outside is not measured later.")},
                    tr("JSON with pairs of pixel and known place")};
        if (id == "static")
            return {
                tr("Static one-shot for several sensors"),
                tr("Puts all sensors of a gripper into one frame, from one picture each of a known plate."),
                {tr("A plate whose place is known (\"Plate in the world\"), seen by the camera."),
                 tr("The laser plane in the camera; the robot tells where the flange stands.")},
                tr("JSON with the chain of poses of each sensor")};
        if (id == "lens")
            return {tr("Lens"),
                    tr("Checks the lens: straight laser lines on a plate must become straight."),
                    {tr("A flat plate that fills the view."),
                     tr("10 or more heights and tilts, so that the lines cross the picture everywhere.")},
                    tr("JSON with lines of pixels")};
        if (id == "plate")
            return {
                tr("Plate in the world"),
                tr("Finds where a plate stands, from points known on it and measured in the world."),
                {tr("A board on the plate and the calibrated sensor on the robot: every capture gives its "
                    "outer "
                    "corners."),
                 tr("Or 6 or more points measured by robot tip, laser tracker or total station, from a file: "
                    "far apart and not on one line.")},
                tr("JSON with points on the plate and in the world")};
        if (id == "drift")
            return {tr("Does the calibration still hold?"),
                    tr("Measures the sphere again and says whether the sensor has moved on its flange."),
                    {tr("The sphere where it stood when the sensor was calibrated."),
                     tr("3 poses from different directions.")},
                    tr("JSON with stored calibration and new profiles")};
        return {id, {}, {}, {}};
    }
    static QString setting(const QString& name) {
        if (name == "radius") return tr("Radius of the sphere");
        if (name == "board_columns") return tr("Corners along");
        if (name == "board_rows") return tr("Corners across");
        if (name == "board_pitch") return tr("Edge of a square");
        if (name == "limit_mm") return tr("Allowed shift");
        if (name == "limit_deg") return tr("Allowed turn");
        return name;
    }
    static QString verdict(Verdict verdict) {
        switch (verdict) {
            case Verdict::good:
                return tr("good");
            case Verdict::usable:
                return tr("usable");
            case Verdict::poor:
                return tr("poor");
            case Verdict::undetermined:
                break;
        }
        return tr("undetermined");
    }
};

}  // namespace

MethodText method_text(const QString& id) {
    return Texts::of(id);
}

QString setting_name(const QString& name) {
    return Texts::setting(name);
}

QString verdict_word(Verdict verdict) {
    return Texts::verdict(verdict);
}

}  // namespace seamwright
