// What a guided page shows, derived from the session.

#include <QStyle>
#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/capture.h"
#include "projects/file/stored_text.h"
#include "projects/measure/measure.h"
#include "widgets/calibrate/verdict_word.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/pages/guided/guided_page.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

using nlohmann::json;

QString text(const std::string& s) {
    return QString::fromStdString(s);
}

QString signed_number(double value, int decimals) {
    return (value >= 0 ? "+" : "") + number(value, decimals);
}

// With axis names and as many decimals as a robot is jogged with.
QString readable(const Pose& pose, PoseNotation notation) {
    const Eigen::Vector3d t = pose.translation();
    QString place = QString("X %1  Y %2  Z %3").arg(number(t.x(), 2), number(t.y(), 2), number(t.z(), 2));
    switch (notation) {
        case PoseNotation::kuka_abc: {
            const KukaAbc a = kuka_from_rotation(pose.linear());
            return place + QString("  A %1  B %2  C %3")
                               .arg(number(a.a_deg, 3), number(a.b_deg, 3), number(a.c_deg, 3));
        }
        case PoseNotation::fanuc_wpr: {
            const FanucWpr a = fanuc_from_rotation(pose.linear());
            return place + QString("  W %1  P %2  R %3")
                               .arg(number(a.w_deg, 3), number(a.p_deg, 3), number(a.r_deg, 3));
        }
        case PoseNotation::abb_quaternion: {
            const AbbQuaternion q = abb_from_rotation(pose.linear());
            return place + QString("  q %1 %2 %3 %4")
                               .arg(number(q.w, 5), number(q.x, 5), number(q.y, 5), number(q.z, 5));
        }
        case PoseNotation::ur_rotvec: {
            const Eigen::Vector3d r = ur_from_rotation(pose.linear());
            return place +
                   QString("  RX %1  RY %2  RZ %3").arg(number(r.x(), 4), number(r.y(), 4), number(r.z(), 4));
        }
        case PoseNotation::matrix:
            break;
    }
    return text_from_pose(pose, notation);
}

constexpr int kLivePicture = 480;
// Shifts and turns below these are not worth a word to a person jogging.
constexpr double kWordMm = 1, kWordDeg = 0.5;

}  // namespace

void GuidedPage::refresh() {
    if (!calibration_.is_open()) return;
    const CalibrationSession& s = calibration_.session();
    if (shown_method_ != s.method().id + "/" + s.sensor_id()) {
        shown_method_ = s.method().id + "/" + s.sensor_id();
        title_->setText(shown(s.method().title));
        why_->setText(shown(s.method().why));
        QStringList need;
        for (const Text& one : s.method().need) need << shown(one);
        need_->setText("• " + need.join("\n• "));
        drawing_->set_drawing(s.method().drawing);
        load_->setToolTip(shown(s.method().file));
        prepare_->setVisible(needs_shown_);
        target_->set_live({}, {}, false, tr("Waiting for the sensor"));
    }
    const bool live = s.method().capture != CaptureKind::files;
    capture_box_->setVisible(live);
    load_folder_->setVisible(reads_images(s.method()));
    refresh_who();
    refresh_stage();
    refresh_settings();
    refresh_table();
    refresh_coverage();
    refresh_next();
    refresh_verdict();
    refresh_use();
    refresh_busy();
}

void GuidedPage::refresh_who() {
    const CalibrationSession& s = calibration_.session();
    QString who = s.method().robot ? tr("Sensor %1 on robot %2").arg(text(s.sensor_id()), text(s.robot_id()))
                                   : tr("Sensor %1").arg(text(s.sensor_id()));
    if (target_set_) who = tr("%1. It sees the simulated target until this page is left.").arg(who);
    who_->setText(who);
}

void GuidedPage::refresh_stage() {
    const CalibrationSession& s = calibration_.session();
    const int at = std::min(static_cast<int>(s.stage()), 4);
    const QStringList names{tr("Prepare"), tr("Capture"), tr("Solve"), tr("Verify"),
                            s.method().use == AnswerUse::sensor ? tr("Use") : tr("Keep")};
    QStringList words;
    for (int i = 0; i < names.size(); ++i)
        words << (i == at ? "<b><span style=\"color:" + style::selection(palette()).name() + "\">" +
                                names[i] + "</span></b>"
                          : names[i]);
    QString line = words.join(QStringLiteral("  ›  "));
    // Why it goes on capturing, where the page is scrolled elsewhere.
    if (const CalibrationSolution* solution = s.solution(); solution && !serves(solution->verdict()))
        line += "<br>" + tr("%1: %2").arg("<b>" + verdict_word(solution->verdict()).toHtmlEscaped() + "</b>",
                                          shown(solution->report.judgement.reason).toHtmlEscaped());
    if (const QString why = missing(); !why.isEmpty()) line += "<br>" + why.toHtmlEscaped();
    stage_->setText(line);
    stage_->setAccessibleDescription(names[at]);
    stage_->setProperty("stage", at);
}

void GuidedPage::refresh_settings() {
    const CalibrationSession& s = calibration_.session();
    const auto editors = settings_holder_->findChildren<ParameterEditor*>();
    if (static_cast<std::size_t>(editors.size()) != s.method().settings.size() ||
        settings_holder_->property("method").toString() != text(s.method().id)) {
        settings_holder_->setProperty("method", text(s.method().id));
        while (QLayoutItem* item = settings_box_->takeAt(0)) {
            if (item->widget()) {
                item->widget()->setParent(nullptr);
                item->widget()->deleteLater();
            }
            delete item;
        }
        for (const MethodSetting& one : s.method().settings) {
            auto* editor = new ParameterEditor(one.info);
            editor->setObjectName("calibration_" + text(one.info.name));
            connect(editor, &ParameterEditor::committed, this,
                    [this, name = one.info.name](double value) { done(calibration_.set(name, value)); });
            editor->set_name(shown(one.label));
            settings_box_->addWidget(editor);
            editor->set_value(setting(one, s.state().settings));
        }
    } else {
        for (std::size_t i = 0; i < s.method().settings.size(); ++i)
            editors[static_cast<int>(i)]->refresh(setting(s.method().settings[i], s.state().settings),
                                                  s.folder().string());
    }
    nominal_holder_->setVisible(s.method().robot && s.method().use == AnswerUse::sensor);
    // Where it is not known, that of the sensor before does not stay.
    nominal_->refresh(calibration_.mounting().value_or(Pose::Identity()), s.folder().string());
    refresh_base();
}

void GuidedPage::refresh_base() {
    const CalibrationSession& s = calibration_.session();
    base_->setVisible(s.method().model || s.method().use == AnswerUse::check);
    const Calibration* base = calibration_.base();
    if (!base)
        return set_verdict(*base_, tr("Camera and laser plane are not calibrated yet: begin with them."),
                           Tone::attention);
    QString built = tr("Built on calibration %1, in use.").arg(text(base->id));
    if (of_all_sensors(s.method().capture)) {
        QStringList shot;
        for (const std::string& id : calibration_.shot_sensors()) {
            const Calibration* used = calibration_of(desk_.project(), id);
            shot << tr("sensor %1 with calibration %2").arg(text(id), used ? text(used->id) : QString());
        }
        built = tr("One capture shoots %1.").arg(shot.join(", "));
    }
    set_verdict(*base_, built, Tone::plain);
}

void GuidedPage::refresh_table() {
    const CalibrationSession& s = calibration_.session();
    const std::vector<PoseRow> rows = s.rows();
    const std::string kept = selected();
    const QSignalBlocker quiet(table_);
    table_->setRowCount(static_cast<int>(rows.size()));
    // What stands out against the others, in the measure that the method has.
    const auto limit = [&](double PoseRow::*part) {
        std::vector<double> used;
        for (const PoseRow& r : rows)
            if (!r.left_out && !r.verification && std::isfinite(r.*part)) used.push_back(r.*part);
        if (used.size() < 4) return std::numeric_limits<double>::infinity();
        std::nth_element(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2),
                         used.end());
        return 3 * used[used.size() / 2];
    };
    const double high_mm = limit(&PoseRow::rms_mm), high_deg = limit(&PoseRow::deg),
                 high_px = limit(&PoseRow::rms_px);
    int row_of_kept = -1;
    for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
        const PoseRow& r = rows[static_cast<std::size_t>(i)];
        const SessionCapture& c = s.state().captures[static_cast<std::size_t>(i)];
        const bool high = r.rms_mm > high_mm || r.deg > high_deg || r.rms_px > high_px;
        QString state = r.left_out       ? tr("left out")
                        : r.verification ? tr("verification")
                        : r.contradicts  ? tr("contradicts the others")
                        : !s.solution()  ? tr("captured")
                        : high           ? tr("stands out")
                                         : tr("used");
        const Tone tone = r.contradicts && !r.left_out ? Tone::alarm
                          : high && !r.left_out        ? Tone::attention
                                                       : Tone::plain;
        const QStringList cells{text(r.id), number(r.rms_mm, 3), number(r.deg, 3), number(r.rms_px, 2),
                                state};
        for (int k = 0; k < cells.size(); ++k) {
            auto* item = new QTableWidgetItem(cells[k]);
            item->setTextAlignment((k == 0 || k == 4 ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
            item->setToolTip(r.note.empty() ? text(c.taken->origin + "  " + c.taken->taken_utc)
                                            : shown(r.note));
            if (tone != Tone::plain) {
                QFont font = table_->font();
                font.setBold(true);
                item->setFont(font);
                item->setForeground(tone == Tone::alarm ? style::alarm(palette())
                                                        : style::attention(palette()));
            }
            if (k == 0) {
                item->setData(Qt::UserRole, text(r.id));
                item->setFlags(item->flags() | Qt::ItemIsUserCheckable);
                item->setCheckState(r.left_out ? Qt::Unchecked : Qt::Checked);
                item->setIcon(thumbnail(c));
            }
            table_->setItem(i, k, item);
        }
        if (r.id == kept) row_of_kept = i;
    }
    if (row_of_kept >= 0) table_->setCurrentCell(row_of_kept, 0);
    const auto any = [&](double PoseRow::*part) {
        return std::any_of(rows.begin(), rows.end(),
                           [&](const PoseRow& r) { return std::isfinite(r.*part); });
    };
    table_->setColumnHidden(1, s.solution() && !any(&PoseRow::rms_mm));
    table_->setColumnHidden(2, s.solution() && !any(&PoseRow::deg));
    table_->setColumnHidden(3, !any(&PoseRow::rms_px));
    const int n = s.solving_captures();
    count_->setText(
        n < s.method().fewest    ? tr("%n capture(s), at least %1 are needed", "", n).arg(s.method().fewest)
        : n < s.method().advised ? tr("%n capture(s), %1 are better", "", n).arg(s.method().advised)
                                 : tr("%n capture(s)", "", n));
}

void GuidedPage::refresh_coverage() {
    const CalibrationSession& s = calibration_.session();
    std::vector<CoverageEntry> entries;
    for (const SessionCapture& c : s.state().captures)
        entries.push_back({picture(c), !c.left_out && !c.verification, c.taken->id == selected()});
    const bool any = std::any_of(entries.begin(), entries.end(),
                                 [](const CoverageEntry& e) { return !e.picture.points.empty(); });
    coverage_->setVisible(any);
    if (!any) return;
    std::optional<ViewMark> next;
    const Pose mounting = calibration_.mounting().value_or(Pose::Identity());
    if (const auto pose = next_pose(s, calibration_.mounting()))
        next = view_mark(s, mounting, pose->base_from_flange);
    coverage_->set_data(std::move(entries), view_marks(s, mounting), next, text(selected()));
}

void GuidedPage::refresh_next() {
    const CalibrationSession& s = calibration_.session();
    if (s.method().capture == CaptureKind::files) return propose(std::nullopt);
    const std::optional<Pose> pose = next_place(s, desk_.project());
    propose(isVisible() ? pose : std::nullopt);
    const RobotSetup* robot = find_robot(desk_.project(), s.robot_id());
    copy_next_->setVisible(pose.has_value());
    const bool touch = s.method().capture == CaptureKind::touch;
    set_target_->setVisible(simulated_sensor() && !touch);
    automatic_->setVisible(!touch);  // standing still is no touch
    const bool moves = desk_.can_move(s.robot_id());
    go_there_->setVisible(moves && pose);
    capture_all_->setVisible(moves && !touch && (pose || s.state().captures.empty()));
    if (touch) {
        next_->setText(
            tr("Bring the tip to the sphere by hand or slowly by jogging, then capture. Turn the flange "
               "between touches."));
        next_words_->hide();
        return;
    }
    if (!pose) {
        next_->setText(
            std::none_of(s.state().captures.begin(), s.state().captures.end(),
                         [](const SessionCapture& c) { return c.taken->base_from_flange.has_value(); })
                ? tr("Jog the sensor until the target is outlined, then capture. The next poses follow from "
                     "the first one.")
            : s.solution() && !serves(s.solution()->verdict())
                ? tr("Every view has been taken and the solution does not serve yet: state the robot's "
                     "repeatability, leave out what stands out, or jog to other places and capture there.")
                : tr("No further pose is proposed: every view has been taken."));
        next_words_->hide();
        return;
    }
    const PoseNotation notation = notation_of_brand(robot ? robot->identity.brand : std::string());
    const QString numbers = text_from_pose(*pose, notation);
    next_->setProperty("pose", numbers);
    next_->setText(
        tr("Next pose of the flange (%1): %2").arg(notation_name(notation), readable(*pose, notation)));
    next_words_->show();
    const auto at = flange();
    if (!at) {
        next_words_->setVisible(desk_.station().connected);
        next_words_->setText(tr("The robot does not tell its pose."));
        return;
    }
    // How the sensor itself moves, in its own axes, as it is jogged in the tool's frame.
    const Pose x = calibration_.mounting().value_or(Pose::Identity());
    const Pose step = (*at * x).inverse() * (*pose * x);
    const Eigen::Vector3d turn = rotation_log(step.linear()) * (180 / kPi);
    QStringList words;
    const char* axes = "XYZ";
    for (int i = 0; i < 3; ++i)
        if (std::abs(turn[i]) >= kWordDeg)
            words << tr("about %1 %2°").arg(axes[i]).arg(signed_number(turn[i], 1));
    QStringList shifts;
    for (int i = 0; i < 3; ++i)
        if (std::abs(step.translation()[i]) >= kWordMm)
            shifts << tr("%1 %2 mm").arg(axes[i]).arg(signed_number(step.translation()[i], 0));
    next_words_->setText(words.isEmpty() && shifts.isEmpty()
                             ? tr("The robot stands there.")
                             : tr("From here, in the sensor's axes: turn %1; shift %2.")
                                   .arg(words.isEmpty() ? tr("nothing") : words.join(", "),
                                        shifts.isEmpty() ? tr("nothing") : shifts.join(", ")));
}

// Offered, never taken by itself.
void GuidedPage::refresh_convention() {
    const ConventionAnswer* answer = calibration_.convention();
    detect_->setVisible(calibration_.convention_in_doubt());
    detect_->setEnabled(!calibration_.busy());
    convention_->setVisible(answer);
    take_convention_->setVisible(answer && !answer->offer.is_null());
    if (!answer) return;
    QStringList lines{shown(answer->found.sentence)};
    const auto residual = [](const std::optional<PoseReading>& reading) {
        return reading && reading->fit ? number(reading->fit->residual_mm, 3) : QStringLiteral("-");
    };
    lines << tr("Residual as given %1 mm, in the best other reading %2 mm")
                 .arg(answer->found.as_given.fit ? number(answer->found.as_given.fit->residual_mm, 3)
                                                 : QStringLiteral("-"),
                      residual(answer->found.best));
    convention_->setText(lines.join(QChar('\n')));
}

void GuidedPage::refresh_verdict() {
    refresh_convention();
    const CalibrationSession& s = calibration_.session();
    const CalibrationSolution* solution = s.solution();
    solve_box_->setVisible(!s.state().captures.empty());
    robot_holder_->setVisible(s.method().repeatability && solution);
    const json robot = s.state().settings.value("robot", json::object());
    const auto stated = [&](const char* key) {
        const auto it = robot.find(key);
        return it != robot.end() && it->is_number() ? it->get<double>() : 0.0;
    };
    robot_mm_->refresh(stated("sigma_mm"), s.folder().string());
    robot_deg_->refresh(stated("sigma_deg"), s.folder().string());
    robot_deg_->setEnabled(stated("sigma_mm") > 0);
    parameters_->setVisible(solution && !solution->report.parameters.empty());
    if (!solution) {
        set_verdict(
            *verdict_,
            s.solving_captures() < s.method().fewest ? tr("not enough captures") : tr("not solved yet"),
            Tone::plain);
        reason_->setText({});
        return;
    }
    const Judgement& judgement = solution->report.judgement;
    set_verdict(*verdict_, verdict_word(judgement.verdict), tone_of(judgement.verdict));
    QStringList lines;
    if (const auto* found = std::get_if<SensorChains>(&solution->found))
        for (const SensorChains::Chain& chain : found->chains) lines << shown(chain.judgement.reason);
    else
        lines << shown(judgement.reason);
    if (!judgement.cure.empty()) lines << tr("Cure: %1").arg(shown(judgement.cure));
    for (const Text& notice : solution->notices) lines << shown(notice);
    reason_->setText(lines.join("\n"));
    QVector<QStringList> rows;
    for (const CalibratedParameter& p : solution->report.parameters) {
        // As many decimals as the sigma deserves: two digits of it.
        const int decimals = std::isfinite(p.sigma) && p.sigma > 0
                                 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(p.sigma))), 0, 9)
                                 : 4;
        rows << QStringList{text(p.name), number(p.value, decimals),
                            (number(p.sigma, decimals) + " " + text(p.unit)).trimmed()};
    }
    set_rows(*parameters_, rows);
}

// Undo in the project takes the calibrations away again.
bool GuidedPage::stored() const {
    const auto& ids = calibration_.session().used_as();
    return !ids.empty() && std::all_of(ids.begin(), ids.end(), [&](const std::string& id) {
        return index_of<Calibration>(desk_.project(), id) >= 0;
    });
}

void GuidedPage::refresh_use() {
    const CalibrationSession& s = calibration_.session();
    const CalibrationSolution* solution = s.solution();
    const bool kept_back = solution && s.method().keeps_back;
    verify_box_->setVisible(kept_back);
    verify_->setVisible(s.method().capture != CaptureKind::files);
    if (kept_back) {
        const Verification v = s.verification();
        QStringList parts;
        if (std::isfinite(v.worst_mm))
            parts << tr("%1 mm of %2 allowed").arg(number(v.worst_mm, 3), number(v.limit_mm, 3));
        if (std::isfinite(v.worst_deg))
            parts << tr("%1° of %2 allowed").arg(number(v.worst_deg, 3), number(v.limit_deg, 3));
        if (std::isfinite(v.worst_px))
            parts << tr("%1 px of %2 allowed").arg(number(v.worst_px, 2), number(v.limit_px, 2));
        if (v.poses == 0 && !v.repeats.empty())
            set_verdict(*verified_,
                        tr("Not verified: %1 stands where %2 was taken, which is solved with, and agrees "
                           "whatever the "
                           "answer. Move the robot and take another.")
                            .arg(text(v.repeats.front().first), text(v.repeats.front().second)),
                        Tone::attention);
        else if (v.poses == 0)
            set_verdict(
                *verified_,
                tr("Not verified: take one more pose that is not solved with, or keep one of the list back."),
                Tone::attention);
        else if (v.confirmed && !serves(solution->verdict()))
            // As wide as such a solution is, nearly every pose agrees with it.
            set_verdict(*verified_,
                        tr("%n pose(s) agree, but the solution is %1: %2", "", v.poses)
                            .arg(verdict_word(solution->verdict()),
                                 parts.isEmpty() ? tr("no residual") : parts.join(", ")),
                        Tone::plain);
        else
            set_verdict(*verified_,
                        (v.confirmed ? tr("confirmed by %n pose(s): %1", "", v.poses)
                                     : tr("not confirmed by %n pose(s): %1", "", v.poses))
                            .arg(parts.isEmpty() ? tr("no residual") : parts.join(", ")),
                        v.confirmed ? Tone::good : Tone::alarm);
    }
    use_->setVisible(s.method().use == AnswerUse::sensor);
    anew_->setVisible(!s.state().captures.empty());
    const bool used = s.stage() == SessionStage::used && stored();
    used_->setVisible(used);
    QStringList ids;
    for (const std::string& id : s.used_as()) ids << text(id);
    set_verdict(*used_, tr("Stored in the project as %1.").arg(ids.join(", ")), Tone::good);
    compared_->hide();
    stands_->hide();
    use_->setText(tr("Use this calibration"));
    if (!solution || s.method().use != AnswerUse::sensor) return;
    const auto made = calibrations_of_session(s, desk_.project());
    const bool chains = s.method().capture == CaptureKind::board_chain;
    if (!made) {
        if (chains) set_verdict(*stands_, shown_error(made.error()), Tone::attention);
        return stands_->setVisible(chains);
    }
    if (made->size() > 1) use_->setText(tr("Use these calibrations"));
    QStringList stored_as, against;
    for (const Calibration& now : *made) {
        stored_as << tr("%1 for sensor %2").arg(text(now.id), text(now.sensor_id));
        const Calibration* before = calibration_of(desk_.project(), now.sensor_id);
        if (!before || std::count(s.used_as().begin(), s.used_as().end(), before->id) > 0) continue;
        const CalibrationDifference d = difference(now, *before);
        const QString words =
            d.points == 0 ? tr("It has nothing in common with calibration %1, in use.").arg(text(before->id))
                          : tr("Against calibration %1, in use: the same pixel lies up to %2 mm elsewhere "
                               "(mean %3 mm); sensor shifted %4 mm, turned %5°.")
                                .arg(text(before->id), number(d.largest_mm, 3), number(d.mean_mm, 3),
                                     number(d.shift_mm, 3), number(d.turn_deg, 3));
        against << (chains ? tr("Sensor %1: %2").arg(text(now.sensor_id), words) : words);
    }
    const QStringList stands{
        tr("The solution stands for these sensors; stored will be: %1.").arg(stored_as.join(", ")),
        tr("One shot leaves no pose to verify it with: compare each sensor with what it used before.")};
    set_verdict(*stands_, stands.join("\n"), Tone::plain);
    stands_->setVisible(chains && !used);
    compared_->setText(against.join("\n"));
    compared_->setVisible(!against.isEmpty());
}

void GuidedPage::refresh_live() {
    if (!isVisible() || !calibration_.is_open()) return;
    // What was seen before is no live picture.
    if (!desk_.station().connected) return target_->set_live({}, {}, false, tr("not connected"));
    const LiveTarget& live = calibration_.live();
    const bool image = live.frame && !live.frame->image.empty() &&
                       calibration_.session().method().capture != CaptureKind::sphere_profile;
    const CaptureKind kind = calibration_.session().method().capture;
    const bool board = shows_board(kind);
    QString words = live.seen ? tr("target seen") : live.words;
    if (!live.seen && board && calibration_.switches_laser())
        words = tr("The board is looked for with the laser off, at the capture.");
    target_->set_live(live.picture, image ? small_picture(live.frame->image, kLivePicture) : QImage(),
                      live.seen, words);
}

}  // namespace seamwright
