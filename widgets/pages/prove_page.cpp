#include "widgets/pages/prove_page.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/present_names.h"
#include "projects/proof/zero_shift.h"
#include "widgets/editors/number_box.h"
#include "widgets/into_view.h"
#include "widgets/pages/parts/type_chooser.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

QString q(const std::string& text) {
    return QString::fromStdString(text);
}

// ". X +7.5 mm: why", of the first that was refused.
QString first_refusal(const KnownShift& proof, const std::string& region_id) {
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions)
            if (o.region_id == region_id && !o.ok && !o.message.empty())
                return QStringLiteral(". ") + q(shift_name(test, proof)) + QStringLiteral(": ") +
                       shown(o.message);
    return {};
}
QString first_refusal(Desk& desk, const ZeroShift& zero) {
    for (const std::int64_t number_of_run : zero.runs)
        if (const auto run = desk.run(number_of_run); run && run->status != RunStatus::ok)
            return QStringLiteral(". ") + shown(run->message);
    return {};
}

}  // namespace

ProvePage::ProvePage(Desk& desk, const Views& views)
    : StepPage(
          desk, views, Step::prove,
          tr("Before anything is corrected: the part as taught reads zero, known shifts are found again, "
             "and the run works without this screen.")) {
    make_head().addWidget(make_progress());  // in sight wherever the page stands
    make_zero_shift();
    make_known_shift();
    make_checklist();
    box().addStretch(1);
    const auto enable = [this] {
        const bool free = desk_.station().connected && !desk_.worker().busy();
        start_zero_->setEnabled(free);
        start_known_->setEnabled(free);
    };
    connect(&desk_, &Desk::station_changed, this, [this, enable] {
        if (isVisible()) enable();
    });
    connect(&desk_.worker(), &StationWorker::place_part, this, &ProvePage::ask_to_place);
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this, enable](bool busy) {
        if (!busy) place_->hide();
        enable();
    });
}

void ProvePage::make_zero_shift() {
    box().addWidget(new TypeChooser(desk_));
    box().addWidget(make_heading(tr("Zero shift")));
    count_ = new QSpinBox;
    count_->setObjectName("zero_runs");
    count_->setRange(2, 200);
    count_->setValue(5);
    add_field(box(), tr("Runs"), count_, tr("How often the unmoved part is measured"));
    start_zero_ = make_button("start_zero", "play", tr("Start zero shift"),
                              tr("Measures; nothing is written to the robot"), [this] {
                                  if (!all_is_taken()) return;
                                  show_known_ = false;
                                  desk_.worker().zero_shift(count_->value(), desk_.selection().part_type());
                              });
    box().addLayout(make_row({start_zero_}));
    zero_verdict_ = make_text({});
    zero_verdict_->setObjectName("zero_verdict");
    box().addWidget(zero_verdict_);
    region_ = new QComboBox;
    region_->setObjectName("zero_region");
    add_field(box(), tr("Region"), region_, tr("The region that the tables and the charts show"));
    connect(region_, &QComboBox::textActivated, this,
            [this](const QString& id) { desk_.selection().select_region(id.toStdString()); });
    zero_table_ = make_table("zero_table", {tr("Direction"), tr("Mean"), tr("3 sigma"), tr("Stated")},
                             tr("Mean and scatter over the zero-shift runs"));
    zero_table_->setMinimumHeight(7 * 34);
    box().addWidget(zero_table_);
    box().addWidget(
        make_text(tr("The mean tells bias, 3 sigma the repeatability; stated is what the correction itself "
                     "claims. The charts beside show every run.")));
}

QDoubleSpinBox* ProvePage::spin(const QString& name, double value, double maximum, int decimals,
                                const QString& unit) {
    auto* box = new NumberBox;
    box->setObjectName(name);
    box->setDecimals(decimals);
    box->setRange(std::pow(10.0, -decimals), maximum);
    box->setValue(value);
    box->setSuffix(unit);
    return box;
}

void ProvePage::make_known_shift() {
    box().addWidget(make_heading(tr("Known shift")));
    box().addWidget(make_text(
        tr("The part is displaced by known amounts along and about X, Y and Z, measured each time, and "
           "what is found is compared with what was done.")));
    by_ = new QComboBox;
    by_->setObjectName("shift_by");
    by_->addItem(tr("the simulated part moves"), static_cast<int>(ShiftBy::simulated_part));
    by_->addItem(tr("the robot's base is shifted from here"), static_cast<int>(ShiftBy::robot_moves));
    by_->addItem(tr("I shift the base or the part"), static_cast<int>(ShiftBy::by_hand));
    by_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    by_->setMinimumContentsLength(16);
    by_->setAccessibleName(tr("How"));
    by_->setMinimumHeight(style::kTargetPx);
    by_->setToolTip(
        tr("A base shift looks to the sensor as if the part had moved. Controllers that hold their own "
           "program "
           "are shifted by hand."));
    box().addWidget(by_);
    const ShiftGrid grid;
    range_mm_ = spin("shift_range_mm", grid.range_mm, 100, 1, tr(" mm"));
    step_mm_ = spin("shift_step_mm", grid.step_mm, 100, 1, tr(" mm"));
    range_deg_ = spin("shift_range_deg", grid.range_deg, 10, 2, tr(" deg"));
    step_deg_ = spin("shift_step_deg", grid.step_deg, 10, 2, tr(" deg"));
    add_field(box(), tr("Translation up to"), range_mm_, tr("Both ways, each axis"));
    add_field(box(), tr("in steps of"), step_mm_, tr("Smaller steps measure more often"));
    add_field(box(), tr("Rotation up to"), range_deg_,
              tr("Both ways, about each axis through the middle of the spots"));
    add_field(box(), tr("in steps of"), step_deg_, tr("Smaller steps measure more often"));
    start_known_ =
        make_button("start_known", "shift", tr("Start known shift"),
                    tr("Measures every displacement; nothing is written to the robot"), [this] {
                        if (!all_is_taken()) return;
                        show_known_ = true;
                        ShiftGrid chosen;
                        chosen.range_mm = range_mm_->value();
                        chosen.step_mm = step_mm_->value();
                        chosen.range_deg = range_deg_->value();
                        chosen.step_deg = step_deg_->value();
                        desk_.worker().known_shift(static_cast<ShiftBy>(by_->currentData().toInt()), chosen,
                                                   desk_.selection().part_type());
                    });
    auto* charts = make_button("show_known", "window", tr("In the charts"),
                               tr("Deviation against displacement in the charts beside"), [this] {
                                   show_known_ = true;
                                   refresh();
                                   views_.raise(views_.trend);
                               });
    box().addLayout(make_row({start_known_, charts}));
    place_ = new QFrame;
    place_->setObjectName("place_part");
    place_->setFrameShape(QFrame::StyledPanel);
    auto* place_box = new QVBoxLayout(place_);
    place_text_ = make_text({});
    place_text_->setObjectName("place_text");
    place_box->addWidget(place_text_);
    place_box->addLayout(
        make_row({make_button("placed", "check", tr("It stands"), tr("Measure this displacement"),
                              [this] {
                                  place_->hide();
                                  desk_.worker().answer_push(true);
                              }),
                  make_button("place_end", "stop", tr("End"), tr("Measure no further displacement"), [this] {
                      place_->hide();
                      desk_.worker().answer_push(false);
                  })}));
    place_->hide();
    box().addWidget(place_);
    known_verdict_ = make_text({});
    known_verdict_->setObjectName("known_verdict");
    box().addWidget(known_verdict_);
    known_table_ =
        make_table("known_table", {tr("Displacement"), tr("Tests"), tr("Mean"), tr("3 rms")},
                   tr("Deviation of the spots' reference points, found minus true, mm; 3 rms counts the "
                      "mean as error too"));
    known_table_->setMinimumHeight(4 * 34 + 8);
    box().addWidget(known_table_);
    box().addWidget(make_heading(tr("What makes the region uncertain")));
    budget_ = new BudgetPanel;
    budget_->setObjectName("prove_budget");
    box().addWidget(budget_);
}

void ProvePage::make_checklist() {
    box().addWidget(make_heading(tr("Commissioning")));
    checklist_ =
        make_table("checklist", {tr("Step"), tr("State")}, tr("Every step of commissioning, derived"));
    checklist_->setMinimumHeight(11 * 34);
    connect(checklist_, &QTableWidget::currentCellChanged, this, &ProvePage::show_item);
    box().addWidget(checklist_);
    finding_ = make_text({});
    finding_->setObjectName("finding");
    box().addWidget(finding_);
    open_ = make_button("open_step", "next", tr("Open its page"), tr("Where this step is worked on"), [this] {
        const int row = checklist_->currentRow();
        if (row < 0 || row >= static_cast<int>(desk_.checks().size())) return;
        const CheckStep item = desk_.checks()[static_cast<std::size_t>(row)].step;
        if (page_of(item) != Step::prove) {
            emit step_wanted(page_of(item));
            return;
        }
        bring_into_view(control_of(item));
        control_of(item)->setFocus(Qt::TabFocusReason);
    });
    box().addLayout(
        make_row({open_, make_button("make_report", "export", tr("Hand-over report..."),
                                     tr("PDF or HTML: devices, calibrations, spots, proofs, limits, events"),
                                     [this] { emit report_wanted(); })}));
}

QWidget* ProvePage::control_of(CheckStep item) {
    return item == CheckStep::zero_shift    ? static_cast<QWidget*>(start_zero_)
           : item == CheckStep::known_shift ? static_cast<QWidget*>(start_known_)
                                            : checklist_;
}

// What is proven by another program or on another page is chosen in the list, which says how.
QWidget* ProvePage::due() {
    for (std::size_t i = 0; i < desk_.checks().size(); ++i) {
        const CheckItem& item = desk_.checks()[i];
        if (item.done() || step_of(item.step) != Step::prove) continue;
        checklist_->setCurrentCell(static_cast<int>(i), 0);
        return control_of(item.step);
    }
    return nullptr;
}

void ProvePage::entered() {
    views_.raise(views_.trend);
}

void ProvePage::refresh() {
    const bool free = desk_.station().connected && !desk_.worker().busy();
    start_zero_->setEnabled(free);
    start_known_->setEnabled(free);
    region_->clear();
    for (const Region& r : desk_.project().regions) region_->addItem(q(r.id));
    region_->setCurrentText(q(desk_.selection().region()));
    refresh_zero_shift();
    refresh_known_shift();
    const int at = index_of<Region>(desk_.project(), region_->currentText().toStdString());
    budget_->show_region(desk_.project(),
                         at < 0 ? nullptr : &desk_.project().regions[static_cast<std::size_t>(at)]);
    refresh_checklist();
}

void ProvePage::refresh_zero_shift() {
    const Evidence* e = newest<ZeroShift>(desk_.facts());
    const std::string id = region_->currentText().toStdString();
    const ZeroShift zero = e ? in_present_names<ZeroShift>(*e, desk_.facts(), desk_.project()) : ZeroShift{};
    const QStringList names{tr("X"), tr("Y"), tr("Z"), tr("A about Z"), tr("B about Y"), tr("C about X")};
    QVector<QStringList> rows;
    double worst = 0;
    for (const ZeroShiftRegion& r : zero.regions) {
        worst = std::max(worst, r.worst_mean_mm);
        if (r.region_id != id) continue;
        for (std::size_t k = 0; k < 6; ++k) {
            const int decimals = k < 3 ? 3 : 4;
            const QString unit = k < 3 ? QStringLiteral(" mm") : QChar(0x20) + shown_word("deg");
            rows << QStringList{names[static_cast<int>(k)], number(r.mean[k], decimals) + unit,
                                number(r.three_sigma[k], decimals) + unit,
                                number(r.stated_three_sigma[k], decimals) + unit};
        }
    }
    set_rows(*zero_table_, rows);
    if (!e)
        set_verdict(*zero_verdict_, tr("not measured yet"), Tone::plain);
    else if (zero.refused > 0)
        set_verdict(*zero_verdict_,
                    tr("%1 of %2 runs were refused").arg(zero.refused).arg(zero.runs.size()) +
                        first_refusal(desk_, zero),
                    Tone::alarm);
    else if (worst > desk_.project().requirements.sigma3_mm)
        set_verdict(*zero_verdict_,
                    tr("%1 runs: the mean moves a spot by %2 mm, more than required")
                        .arg(zero.runs.size())
                        .arg(number(worst, 3)),
                    Tone::attention);
    else
        set_verdict(*zero_verdict_,
                    tr("%1 runs read zero: the mean moves no spot by more than %2 mm")
                        .arg(zero.runs.size())
                        .arg(number(worst, 3)),
                    Tone::good);
    if (isVisible() && !show_known_) draw_zero_shift(zero);
}

void ProvePage::draw_zero_shift(const ZeroShift& zero) {
    // The runs say the region's name of their time.
    std::string id = region_->currentText().toStdString();
    if (const Evidence* e = newest<ZeroShift>(desk_.facts()))
        for (std::size_t i = 0; i < zero.regions.size(); ++i)
            if (zero.regions[i].region_id == id) {
                id = std::get<ZeroShift>(e->what).regions[i].region_id;
                break;
            }
    std::vector<QString> labels;
    std::vector<TrendSeries> moves{{tr("X"), {}}, {tr("Y"), {}}, {tr("Z"), {}}};
    for (const std::int64_t number_of_run : zero.runs) {
        const auto run = desk_.run(number_of_run);
        if (!run) continue;  // deleted since
        Eigen::Vector3d shift = Eigen::Vector3d::Constant(std::nan(""));
        for (const RegionRecord& r : run->regions)
            if (r.region_id == id && r.correction)
                shift = r.correction->displacement.workobject_from_movedworkobject.translation();
        labels.push_back(QString::number(number_of_run));
        for (int k = 0; k < 3; ++k) moves[static_cast<std::size_t>(k)].values.push_back(shift[k]);
    }
    views_.trend->set_data(tr("Zero shift of region %1").arg(region_->currentText()), QStringLiteral("mm"),
                           labels, moves, {});
    views_.histogram->set_data(tr("Zero shift, X Y Z"), QStringLiteral("mm"), moves, {});
}

void ProvePage::refresh_known_shift() {
    const Evidence* e = newest<KnownShift>(desk_.facts());
    const std::string id = region_->currentText().toStdString();
    const KnownShift proof =
        e ? in_present_names<KnownShift>(*e, desk_.facts(), desk_.project()) : KnownShift{};
    const QStringList kinds{tr("translation"), tr("rotation"), tr("both")};
    QVector<QStringList> rows;
    for (const ShiftStatistic& s : statistics(proof)) {
        if (s.region_id != id) continue;
        rows << QStringList{
            kinds[static_cast<int>(s.kind)],
            s.refused ? tr("%1, %2 refused").arg(s.tests).arg(s.refused) : QString::number(s.tests),
            number(s.summary.mean, 3), number(s.about_truth_mm, 3)};
    }
    set_rows(*known_table_, rows);
    const double required = desk_.project().requirements.sigma3_mm;
    const ProvenAccuracy proven = proven_accuracy(proof, id);
    if (!e)
        set_verdict(*known_verdict_, tr("not measured yet"), Tone::plain);
    else if (proven.refused > 0)
        set_verdict(*known_verdict_,
                    tr("Region %1: %2 of %3 displacements were refused")
                            .arg(region_->currentText())
                            .arg(proven.refused)
                            .arg(proven.tests) +
                        first_refusal(proof, id),
                    Tone::alarm);
    else
        set_verdict(*known_verdict_,
                    (proven.three_sigma_mm <= required ? tr("Region %1: recovered, 3 rms %2 mm of %3 mm")
                                                       : tr("Region %1: not recovered, 3 rms %2 mm of %3 mm"))
                        .arg(region_->currentText(), number(proven.three_sigma_mm, 3), number(required, 3)),
                    proven.three_sigma_mm <= required ? Tone::good : Tone::alarm);
    if (isVisible() && show_known_) draw_known_shift(proof);
}

void ProvePage::draw_known_shift(const KnownShift& proof) {
    const std::string id = region_->currentText().toStdString();
    std::vector<QString> labels;
    TrendSeries mean{tr("mean deviation"), {}};
    std::vector<TrendSeries> axes{{tr("X"), {}}, {tr("Y"), {}}, {tr("Z"), {}}};
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions) {
            if (o.region_id != id) continue;
            labels.push_back(shown_shift(q(shift_name(test, proof))));
            mean.values.push_back(o.deviations_mm.empty() ? std::nan("") : o.mean_abs_mm);
            for (std::size_t i = 0; i < o.deviations_mm.size(); ++i)
                axes[i % 3].values.push_back(o.deviations_mm[i]);
        }
    const double required = desk_.project().requirements.sigma3_mm;
    views_.trend->set_data(tr("Known shift of region %1").arg(region_->currentText()), QStringLiteral("mm"),
                           labels, {mean}, {std::nullopt, required});
    views_.histogram->set_data(tr("Deviations X Y Z at the spots"), QStringLiteral("mm"), axes,
                               {-required, required});
}

void ProvePage::refresh_checklist() {
    QVector<QStringList> rows;
    int open = -1;
    for (const CheckItem& item : desk_.checks()) {
        if (open < 0 && !item.done()) open = static_cast<int>(rows.size());
        rows << QStringList{
            q(name_of(item.step).in(desk_.language())),
            (item.done() ? QStringLiteral("✓ ") : QString()) + q(name_of(item.status).in(desk_.language()))};
    }
    set_rows(*checklist_, rows);
    if (checklist_->currentRow() < 0) checklist_->setCurrentCell(std::max(0, open), 0);
    show_item();
}

void ProvePage::show_item() {
    const int row = checklist_->currentRow();
    open_->setEnabled(row >= 0);
    if (row < 0 || row >= static_cast<int>(desk_.checks().size())) return finding_->setText({});
    const CheckItem& item = desk_.checks()[static_cast<std::size_t>(row)];
    QStringList lines;
    for (const Text& line : item.evidence) lines << q(line.in(desk_.language()));
    set_verdict(*finding_,
                q(item.why.in(desk_.language())) + (lines.isEmpty() ? QString() : "\n" + lines.join('\n')),
                Tone::plain);
}

void ProvePage::ask_to_place(const QString& name, const Pose& shift) {
    const KukaAbc abc = kuka_from_rotation(shift.linear());
    const Eigen::Vector3d t = shift.translation();
    place_text_->setText(
        tr("%1\nSet the controller's base shift to\nX %2  Y %3  Z %4 mm\nA %5  B %6  C %7 deg")
            .arg(name, number(t.x(), 3), number(t.y(), 3), number(t.z(), 3), number(abc.a_deg, 4),
                 number(abc.b_deg, 4), number(abc.c_deg, 4)));
    place_->show();
}

}  // namespace seamwright
