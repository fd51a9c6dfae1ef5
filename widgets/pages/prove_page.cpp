#include "widgets/pages/prove_page.h"

#include <cmath>

#include "core/geometry/notation.h"

namespace seamwright {
namespace {

// The six numbers of a displacement as printed: mm and degrees.
std::array<double, 6> numbers_of(const Pose& d) {
    const KukaAbc abc = kuka_from_rotation(d.linear());
    return {d.translation().x(), d.translation().y(), d.translation().z(), abc.a_deg, abc.b_deg, abc.c_deg};
}

}  // namespace

ProvePage::ProvePage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::prove,
               tr("Before anything is corrected: the part as taught, not touched, measured several times. "
                  "Every number "
                  "must be zero within its scatter.")) {
    count_ = new QSpinBox;
    count_->setObjectName("zero_runs");
    count_->setRange(kZeroShiftRuns, 200);
    count_->setValue(5);
    add_field(box(), tr("Runs"), count_, tr("How often the unmoved part is measured"));
    start_ = make_button("start_zero", "play", tr("Start zero shift"),
                         tr("Measures; nothing is written to the robot"),
                         [this] { desk_.worker().zero_shift(count_->value()); });
    box().addLayout(make_row({start_}));
    box().addWidget(make_progress());
    verdict_ = make_text({});
    verdict_->setObjectName("zero_verdict");
    box().addWidget(verdict_);
    region_ = new QComboBox;
    region_->setObjectName("zero_region");
    add_field(box(), tr("Region"), region_, tr("The region that the table and the charts show"));
    connect(region_, &QComboBox::textActivated, this,
            [this](const QString& id) { desk_.selection().select_region(id.toStdString()); });
    table_ = make_table("zero_table", {tr("Direction"), tr("Mean"), tr("3 sigma"), tr("Stated 3 sigma")},
                        tr("Mean and scatter over the zero-shift runs"));
    table_->setMinimumHeight(7 * 34);
    box().addWidget(table_);
    box().addWidget(
        make_text(tr("The mean tells bias, 3 sigma the repeatability; stated is what the correction itself "
                     "claims. The charts beside show every run.")));
    box().addStretch(1);
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) start_->setEnabled(desk_.station().connected && !desk_.worker().busy());
    });
}

void ProvePage::entered() {
    views_.raise(views_.trend);
}

void ProvePage::refresh() {
    start_->setEnabled(desk_.station().connected);
    const Project& p = desk_.project();
    region_->clear();
    for (const Region& r : p.regions) region_->addItem(QString::fromStdString(r.id));
    region_->setCurrentText(QString::fromStdString(desk_.selection().region()));
    const std::string id = region_->currentText().toStdString();
    const auto runs = desk_.runs();
    if (!runs) {
        done(tl::unexpected(runs.error()));
        return;
    }
    // The newest row of zero-shift runs, oldest first.
    std::vector<RunSummary> row;
    for (auto it = runs->rbegin(); it != runs->rend(); ++it) {
        if (!it->part_id.starts_with(kZeroShiftPrefix)) continue;
        if (!row.empty() && row.back().setup != it->setup) break;
        row.push_back(*it);
        if (it->part_id == std::string(kZeroShiftPrefix) + "1") break;
    }
    std::reverse(row.begin(), row.end());
    std::vector<QString> labels;
    std::vector<TrendSeries> moves(3), turns(3);
    const QStringList names{tr("X"), tr("Y"), tr("Z"), tr("A about Z"), tr("B about Y"), tr("C about X")};
    for (int k = 0; k < 3; ++k)
        moves[static_cast<std::size_t>(k)].name = names[k],
        turns[static_cast<std::size_t>(k)].name = names[k + 3];
    std::array<std::vector<double>, 6> values;
    std::array<double, 6> stated{};
    int refused = 0;
    for (const RunSummary& summary : row) {
        auto run = desk_.run(summary.number);
        if (!run) continue;
        refused += summary.status != RunStatus::ok;
        labels.push_back(QString::number(summary.number));
        std::array<double, 6> six;
        six.fill(std::nan(""));
        for (const RegionRecord& r : run->regions)
            if (r.region_id == id && r.correction) {
                six = numbers_of(r.correction->displacement.workobject_from_movedworkobject);
                for (int k = 0; k < 3; ++k) {
                    stated[static_cast<std::size_t>(k)] = 3 * r.correction->sigma_xyz_mm[k];
                    stated[static_cast<std::size_t>(k) + 3] = 3 * r.correction->sigma_abc_deg[k];
                }
            }
        for (std::size_t k = 0; k < 6; ++k) {
            (k < 3 ? moves[k] : turns[k - 3]).values.push_back(six[k]);
            if (std::isfinite(six[k])) values[k].push_back(six[k]);
        }
    }
    QVector<QStringList> rows;
    double worst_mean = 0;
    for (std::size_t k = 0; k < 6; ++k) {
        double mean = std::nan(""), sigma = std::nan("");
        if (!values[k].empty()) {
            mean = 0;
            for (double v : values[k]) mean += v / static_cast<double>(values[k].size());
        }
        if (values[k].size() > 1) {
            sigma = 0;
            for (double v : values[k]) sigma += (v - mean) * (v - mean);
            sigma = std::sqrt(sigma / static_cast<double>(values[k].size() - 1));
        }
        // Judged against what the correction claims for a mean of so many runs.
        if (stated[k] > 0 && std::isfinite(mean))
            worst_mean = std::max(worst_mean, std::abs(mean) / stated[k]);
        const int decimals = k < 3 ? 3 : 4;
        const QString unit = k < 3 ? QStringLiteral(" mm") : QStringLiteral(" deg");
        rows << QStringList{names[static_cast<int>(k)], number(mean, decimals) + unit,
                            number(3 * sigma, decimals) + unit, number(stated[k], decimals) + unit};
    }
    set_rows(*table_, row.empty() ? QVector<QStringList>{} : rows);
    if (row.empty())
        set_verdict(*verdict_, tr("not measured yet"), Tone::plain);
    else if (refused > 0)
        set_verdict(*verdict_, tr("%1 of %2 runs were refused").arg(refused).arg(row.size()), Tone::alarm);
    else if (worst_mean > 1)
        set_verdict(*verdict_, tr("%1 runs: the mean is off zero by more than 3 sigma").arg(row.size()),
                    Tone::attention);
    else
        set_verdict(*verdict_, tr("%1 runs read zero within 3 sigma").arg(row.size()), Tone::good);
    if (!isVisible()) return;
    views_.trend->set_data(tr("Zero shift of region %1").arg(region_->currentText()), QStringLiteral("mm"),
                           labels, moves, {});
    std::vector<double> all;
    for (const TrendSeries& s : moves) all.insert(all.end(), s.values.begin(), s.values.end());
    views_.histogram->set_data(tr("Zero shift, X Y Z"), QStringLiteral("mm"), all, {});
}

}  // namespace seamwright
