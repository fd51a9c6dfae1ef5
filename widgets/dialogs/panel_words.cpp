// What the panel's window says of a measurement: rows, sentences.

#include <QDateTime>
#include <algorithm>
#include <cmath>

#include "projects/panel/panel_measure.h"
#include "projects/panel/panel_sensitivity.h"
#include "widgets/dialogs/panel_dialog.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/words.h"

namespace seamwright::panel_words {
namespace {

constexpr int kMmDecimals = 3, kDegDecimals = 3;

QString signed_mm(double value) {
    if (!std::isfinite(value)) return QStringLiteral("-");
    return (value < 0 ? QString() : QStringLiteral("+")) + number(value, kMmDecimals);
}

QString with_sigma(double value, double sigma) {
    return PanelDialog::tr("%1 ± %2").arg(number(value, kMmDecimals), number(sigma, kMmDecimals));
}

QString both(double gap_mm, double flush_mm) {
    return PanelDialog::tr("%1 / %2").arg(signed_mm(gap_mm), signed_mm(flush_mm));
}

QString heads_of(const PanelPlace& place) {
    QStringList heads{QString::fromStdString(place.sensor_id)};
    if (!place.second_sensor_id.empty()) heads << QString::fromStdString(place.second_sensor_id);
    return heads.join(" + ");
}

template <class Of>
auto* of_place(Of& all, const std::string& id) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& one) {
        if constexpr (requires { one.place_id; })
            return one.place_id == id;
        else
            return one.id == id;
    });
    return at == all.end() ? nullptr : &*at;
}

QString state_of(const PanelJob& job, const PanelPlace& place, const PanelMeasurement& m) {
    if (m.status != SpotStatus::measured) {
        const QString word = shown_word(to_string(m.status));
        return m.message.empty() ? word : word + ": " + shown(m.message);
    }
    QString words = beyond_tolerance(job, std::span(&m, 1)).empty() ? PanelDialog::tr("in tolerance")
                                                                    : PanelDialog::tr("beyond tolerance");
    if (!place.second_sensor_id.empty())
        words += ", " + PanelDialog::tr("heads %1 mm").arg(number(m.head_disagreement_mm, kMmDecimals));
    return words;
}

QStringList place_row(const PanelJob& job, const PanelPlace& place, const PanelRecord* record) {
    const QString none = QStringLiteral("-");
    QStringList row{
        QString::fromStdString(place.id), heads_of(place), none, none, none, none, none, none, {}};
    if (!place.enabled) {
        row[8] = PanelDialog::tr("switched off");
        return row;
    }
    const PanelMeasurement* before = record ? of_place(record->before, place.id) : nullptr;
    if (!before && place.panel_reference_mm == place.body_reference_mm) {
        row[8] = PanelDialog::tr("not taught");
        return row;
    }
    if (!before) {
        row[8] = PanelDialog::tr("taught: gap %1, flush %2")
                     .arg(number(place.gap_mm, kMmDecimals), signed_mm(place.flush_mm));
        return row;
    }
    if (before->status == SpotStatus::measured) {
        row[2] = with_sigma(before->gap_mm, std::sqrt(before->gap_flush_covariance(0, 0)));
        row[3] = signed_mm(before->gap_mm - place.gap_mm);
        row[4] = with_sigma(before->flush_mm, std::sqrt(before->gap_flush_covariance(1, 1)));
        row[5] = signed_mm(before->flush_mm - place.flush_mm);
    }
    if (record->fit)
        if (const PanelSpotResult* left = of_place(record->fit->spots, place.id))
            row[6] = both(left->remaining.gap_mm, left->remaining.flush_mm);
    const PanelMeasurement* after = of_place(record->after, place.id);
    if (after && after->status == SpotStatus::measured)
        row[7] = both(after->gap_mm - place.gap_mm, after->flush_mm - place.flush_mm);
    row[8] = state_of(job, place, after ? *after : *before);
    return row;
}

}  // namespace

QStringList place_header() {
    return {PanelDialog::tr("Place"),
            PanelDialog::tr("Heads"),
            PanelDialog::tr("Gap, mm"),
            PanelDialog::tr("off taught"),
            PanelDialog::tr("Flush, mm"),
            PanelDialog::tr("off taught"),
            PanelDialog::tr("One step leaves, mm\ngap / flush"),
            PanelDialog::tr("After it, mm\ngap / flush"),
            PanelDialog::tr("State")};
}

QVector<QStringList> place_rows(const PanelJob* job, const PanelRecord* record, const PanelFit* from_file) {
    QVector<QStringList> rows;
    if (from_file) {
        const QString none = QStringLiteral("-");
        for (const PanelSpotResult& s : from_file->spots)
            rows << QStringList{QString::fromStdString(s.id),
                                none,
                                number(s.taught.gap_mm + s.before.gap_mm, kMmDecimals),
                                signed_mm(s.before.gap_mm),
                                number(s.taught.flush_mm + s.before.flush_mm, kMmDecimals),
                                signed_mm(s.before.flush_mm),
                                both(s.remaining.gap_mm, s.remaining.flush_mm),
                                none,
                                s.panel_used && s.body_used
                                    ? QString()
                                    : PanelDialog::tr("left out: contradicts the others")};
        return rows;
    }
    if (!job) return rows;
    for (const PanelPlace& place : job->places) rows << place_row(*job, place, record);
    return rows;
}

QVector<QStringList> motion_rows(const PanelFit* fit, const PanelServo* servo) {
    QVector<QStringList> rows;
    if (!fit && !servo) return rows;
    const std::array<QString, 6> axes = {PanelDialog::tr("X, mm"),  PanelDialog::tr("Y, mm"),
                                         PanelDialog::tr("Z, mm"),  PanelDialog::tr("A, deg"),
                                         PanelDialog::tr("B, deg"), PanelDialog::tr("C, deg")};
    std::array<double, 6> step{}, moved{};
    if (fit) step = six(fit->gripper_motion);
    if (servo) moved = six(servo->motion);
    for (std::size_t k = 0; k < 6; ++k) {
        const int decimals = k < 3 ? kMmDecimals : kDegDecimals;
        const double sigma = !fit    ? std::nan("")
                             : k < 3 ? fit->sigma_xyz_mm[static_cast<int>(k)]
                                     : fit->sigma_abc_deg[static_cast<int>(k) - 3];
        rows << QStringList{axes[k], fit ? number(step[k], decimals) : QStringLiteral("-"),
                            number(sigma, decimals),
                            servo ? number(moved[k], decimals) : QStringLiteral("-")};
    }
    return rows;
}

QString motion_sentence(const Pose& motion) {
    const auto v = six(motion);
    return PanelDialog::tr(
               "the gripper by %1 mm and %2 degrees (X %3  Y %4  Z %5 mm, A %6  B %7  C %8 degrees)")
        .arg(number(motion.translation().norm(), 2),
             number(deg_from_rad(angle_rad(motion, Pose::Identity())), 3), number(v[0], 2), number(v[1], 2),
             number(v[2], 2), number(v[3], 3), number(v[4], 3), number(v[5], 3));
}

QString status_word(ServoingStatus status) {
    switch (status) {
        case ServoingStatus::reached:
            return PanelDialog::tr("reached");
        case ServoingStatus::settled:
            return PanelDialog::tr("stands still");
        case ServoingStatus::diverged:
            return PanelDialog::tr("the deviations grow");
        case ServoingStatus::not_converged:
            return PanelDialog::tr("not reached");
        case ServoingStatus::ill_conditioned:
            return PanelDialog::tr("ill-conditioned");
    }
    return {};
}

QString servo_sentence(const PanelRecord& record) {
    const ServoComparison c = compare_servo(record);
    if (c.moves == 0) return {};
    QString said = PanelDialog::tr("Servoing, %n move(s): %1, from %2 to %3 mm rms.", nullptr, c.moves)
                       .arg(status_word(record.servo->status), number(c.before_rms_mm, kMmDecimals),
                            number(c.after_rms_mm, kMmDecimals));
    if (record.fit)
        said += " " +
                PanelDialog::tr("One step would leave %1 mm; the two motions are %2 mm and %3 degrees apart.")
                    .arg(number(c.single_rms_mm, kMmDecimals), number(c.apart_mm, kMmDecimals),
                         number(c.apart_deg, kDegDecimals));
    return said;
}

QString sensitivity_sentence(const Project& project, const PanelJob& job, bool& attention) {
    attention = false;
    if (!job.sensitivity)
        return PanelDialog::tr("Sensitivity: not learnt. Servoing needs it, one step does not.");
    const PanelSensitivity& s = *job.sensitivity;
    const QDateTime at = QDateTime::fromString(QString::fromStdString(s.utc), Qt::ISODateWithMs);
    QString said =
        PanelDialog::tr("Sensitivity: learnt %1 by %2 moves of %3 mm and %4 degrees, condition %5.")
            .arg(at.toLocalTime().toString("dd.MM.yyyy HH:mm"))
            .arg(kLearningMoves)
            .arg(number(s.step_mm, 2), number(s.step_deg, 2), number(s.condition, 1));
    const auto beside = compare_sensitivity(project, job);
    if (!beside) {
        attention = true;
        return said + " " + shown_error(beside.error());
    }
    attention = !(beside->off_share <= kSensitivityShare);
    said += " " + PanelDialog::tr("%1 % off the computed one; largest difference: %2, %3 mm a move.")
                      .arg(number(100 * beside->off_share, 1),
                           (beside->flush ? PanelDialog::tr("flush of %1") : PanelDialog::tr("gap of %1"))
                               .arg(QString::fromStdString(beside->place)),
                           number(beside->largest_mm, kMmDecimals));
    if (attention) said += " " + PanelDialog::tr("Learn it anew, or look at the sensors' calibrations.");
    return said;
}

}  // namespace seamwright::panel_words
