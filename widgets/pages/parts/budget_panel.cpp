#include "widgets/pages/parts/budget_panel.h"

#include <QVBoxLayout>
#include <algorithm>

#include "projects/proof/budget/budget_advice.h"
#include "projects/proof/budget/budget_page.h"
#include "widgets/pages/parts/step_page.h"
#include "widgets/shown_text.h"
#include "widgets/words.h"

namespace seamwright {

BudgetPanel::BudgetPanel(QWidget* parent) : QWidget(parent), shares_(new ShareBars) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    const auto text = [&](const char* name) {
        QLabel* label = make_text({});
        label->setObjectName(QString::fromLatin1(name));
        box->addWidget(label);
        return label;
    };
    said_ = text("budget");
    shares_->setObjectName("budget_shares");
    box->addWidget(shares_);
    mend_ = text("budget_mend");
    missing_ = text("budget_missing");
}

void BudgetPanel::show_region(const Project& project, const Region* region) {
    shares_->set_data({});
    mend_->clear();
    missing_->clear();
    said_->clear();
    if (!region) return;
    const auto budget = worst_budget(project, *region);
    const MeasurandBudget* m = budget ? worst_across_bead(*budget) : nullptr;
    if (!m) {
        said_->setText(shown(budget ? budget->message : budget.error().text()));
        return;
    }
    said_->setText(tr("Across the bead at spot %1, where it is worst: u = %2 mm (random %3, systematic %4), "
                      "U = %5 mm (95 %). The shares of the variance:")
                       .arg(QString::fromStdString(budget->spot_id), number(m->u, 3), number(m->u_random, 3),
                            number(m->u_systematic, 3), number(m->expanded, 3)));
    std::vector<ShareOfWhole> shares;
    for (const BudgetRow& row : m->rows)
        shares.push_back({shown(name_of(row.source)) + QChar(0x20) + QString::fromStdString(row.owner),
                          100 * row.share, is_systematic(row.source)});
    std::stable_sort(shares.begin(), shares.end(),
                     [](const ShareOfWhole& a, const ShareOfWhole& b) { return a.percent > b.percent; });
    shares_->set_data(std::move(shares));
    constexpr std::size_t kMost = 3;
    QStringList mend;
    for (const Mending& one : mendings(*budget)) {
        if (static_cast<std::size_t>(mend.size()) == kMost) break;
        mend << tr("%1 % of it, u = %2 mm without: %3")
                    .arg(number(100 * one.share, 0), number(one.u_mm, 3), shown(one.what));
    }
    if (!mend.empty()) mend_->setText(tr("What to mend, the largest first:") + QChar('\n') + mend.join('\n'));
    QStringList missing;
    for (const Text& remark : budget->remarks) missing << shown(remark);
    if (!missing.empty())
        missing_->setText(tr("Not stated, therefore not in it:") + QChar('\n') + missing.join('\n'));
}

}  // namespace seamwright
