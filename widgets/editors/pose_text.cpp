#include <QCoreApplication>
#include <QRegularExpression>
#include <cmath>

#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"

namespace seamwright {

namespace {

constexpr double kMostTurn_deg = 360;

// Decimal commas only where nothing else separates: "1,5; 2,5". Otherwise a comma separates.
std::vector<double> numbers_of(QString text) {
    text.replace(QChar(0x2212), '-');
    static const QRegularExpression names(R"((?<![0-9.eE])[A-Za-z_]+[0-9]*\s*[:=]?)");
    text.replace(names, " ");
    static const QRegularExpression brackets(R"([\[\](){}|:=°])");
    text.replace(brackets, " ");
    if (text.contains(';') ||
        (!text.contains('.') && text.contains(QRegularExpression(R"(\d,\d+\s+[+-]?\d)"))))
        text.replace(',', '.');
    std::vector<double> numbers;
    static const QRegularExpression between(R"([\s,;]+)");
    for (const QString& word : text.split(between, Qt::SkipEmptyParts)) {
        const auto number = number_from_text(word);
        if (!number) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

// Lines of a table that are a pose each: two of six numbers are no matrix.
int poses_of(const QString& text) {
    int rows = 0;
    for (const QString& line : text.split('\n', Qt::SkipEmptyParts)) {
        const std::size_t numbers = numbers_of(line).size();
        rows += numbers == 6 || numbers == 7;
    }
    return rows;
}

// The unit behind a number that is not the pose's own, which is millimetres and degrees, and radians of a rotation vector.
QString foreign_unit(const QString& text, PoseNotation notation) {
    static const QRegularExpression lengths(R"([0-9.,]\s*(m|dm|cm|in|inch|ft|µm|um)(?![A-Za-z0-9_]))");
    static const QRegularExpression radians(R"([0-9.,]\s*(rad)(?![A-Za-z0-9_]))");
    if (const auto found = lengths.match(text); found.hasMatch()) return found.captured(1);
    const auto found = notation == PoseNotation::ur_rotvec ? QRegularExpressionMatch() : radians.match(text);
    return found.hasMatch() ? found.captured(1) : QString();
}

}  // namespace

bool is_of_one_field(const QString& text) {
    static const QRegularExpression number(R"(\d+([.,]\d*)?|[.,]\d+)");
    auto found = number.globalMatch(text);
    if (found.hasNext()) found.next();
    return !found.hasNext();
}

QString notation_name(PoseNotation notation) {
    switch (notation) {
        case PoseNotation::kuka_abc:
            return PoseEditor::tr("KUKA A B C (Z-Y'-X'')");
        case PoseNotation::fanuc_wpr:
            return PoseEditor::tr("FANUC W P R");
        case PoseNotation::abb_quaternion:
            return PoseEditor::tr("ABB quaternion (w first)");
        case PoseNotation::ur_rotvec:
            return PoseEditor::tr("UR rotation vector");
        case PoseNotation::matrix:
            return PoseEditor::tr("Matrix 4 x 4");
    }
    return {};
}

PoseNotation notation_of_brand(const std::string& brand) {
    const QString name = QString::fromStdString(brand).toLower();
    if (name.contains("abb")) return PoseNotation::abb_quaternion;
    if (name.contains("fanuc")) return PoseNotation::fanuc_wpr;
    if (name.contains("universal") || name == "ur" || name.startsWith("ur-") || name.startsWith("ur "))
        return PoseNotation::ur_rotvec;
    return PoseNotation::kuka_abc;
}

Expected<Pose> pose_from_text(const QString& text, PoseNotation notation) {
    const std::vector<double> n = numbers_of(text);
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    const std::string where = "pose";
    if (const QString unit = foreign_unit(text, notation); !unit.isEmpty())
        return input_error(
            QCoreApplication::translate("seamwright::PoseEditor", "a number in %1").arg(unit).toStdString(),
            where,
            QCoreApplication::translate("seamwright::PoseEditor", "give millimetres and degrees")
                .toStdString());
    if (const auto rows = poses_of(text); rows > 1)
        return input_error(
            QCoreApplication::translate("seamwright::PoseEditor", "%n pose(s), one a line", "", rows)
                .toStdString(),
            where, QCoreApplication::translate("seamwright::PoseEditor", "give one of them").toStdString());
    if (n.size() == 16 || n.size() == 12) {
        for (std::size_t i = 0; i < n.size(); ++i)
            matrix(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = n[i];
        return pose_from_matrix(matrix, where);
    }
    if (n.size() != 6 && n.size() != 7)
        return input_error(
            QCoreApplication::translate("seamwright::PoseEditor", "a pose of %1 numbers")
                .arg(n.size())
                .toStdString(),
            where,
            QCoreApplication::translate("seamwright::PoseEditor",
                                        "give 6 numbers, 7 with a quaternion, 12 or 16 as a matrix")
                .toStdString());
    const Eigen::Vector3d xyz(n[0], n[1], n[2]);
    const bool degrees = n.size() == 6 && notation != PoseNotation::ur_rotvec;
    for (std::size_t i = 3; degrees && i < n.size(); ++i)
        if (std::abs(n[i]) > kMostTurn_deg)
            return input_error(
                QCoreApplication::translate("seamwright::PoseEditor", "an angle of %1 degrees")
                    .arg(n[i], 0, 'g', 6)
                    .toStdString(),
                where,
                QCoreApplication::translate("seamwright::PoseEditor", "give degrees from -360 to 360")
                    .toStdString());
    Eigen::Matrix3d rotation;
    if (n.size() == 7) {
        SEAM_TRY(const auto turned, rotation_from_abb({n[3], n[4], n[5], n[6]}, where));
        rotation = turned;
    } else if (notation == PoseNotation::ur_rotvec) {
        rotation = rotation_from_ur({n[3], n[4], n[5]});
    } else if (notation == PoseNotation::fanuc_wpr) {
        rotation = rotation_from_fanuc({n[3], n[4], n[5]});
    } else {
        rotation = rotation_from_kuka({n[3], n[4], n[5]});
    }
    matrix.topLeftCorner<3, 3>() = rotation;
    matrix.topRightCorner<3, 1>() = xyz;
    return pose_from_matrix(matrix, where);
}

QString text_from_pose(const Pose& pose, PoseNotation notation) {
    QStringList words;
    const auto add = [&words](double value, int decimals) { words << text_from_number(value, decimals); };
    if (notation == PoseNotation::matrix) {
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                add(pose.matrix()(row, column), column == 3 && row < 3 ? 4 : 8);
        return words.join(' ');
    }
    for (int i = 0; i < 3; ++i) add(pose.translation()[i], 4);
    const Eigen::Matrix3d rotation = pose.linear();
    switch (notation) {
        case PoseNotation::fanuc_wpr: {
            const FanucWpr wpr = fanuc_from_rotation(rotation);
            for (const double v : {wpr.w_deg, wpr.p_deg, wpr.r_deg}) add(v, 5);
            break;
        }
        case PoseNotation::abb_quaternion: {
            const AbbQuaternion q = abb_from_rotation(rotation);
            for (const double v : {q.w, q.x, q.y, q.z}) add(v, 8);
            break;
        }
        case PoseNotation::ur_rotvec: {
            const Eigen::Vector3d v = ur_from_rotation(rotation);
            for (int i = 0; i < 3; ++i) add(v[i], 7);
            break;
        }
        default: {
            const KukaAbc abc = kuka_from_rotation(rotation);
            for (const double v : {abc.a_deg, abc.b_deg, abc.c_deg}) add(v, 5);
        }
    }
    return words.join(' ');
}

}  // namespace seamwright
