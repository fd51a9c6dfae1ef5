#include "widgets/pages/parts/spot_tree.h"

#include <QHeaderView>

#include "projects/measure/measure.h"
#include "projects/proof/checklist.h"
#include "widgets/style.h"

namespace seamwright {
namespace {
constexpr int kKind = Qt::UserRole, kId = Qt::UserRole + 1;
}

SpotTree::SpotTree(Desk& desk, QWidget* parent) : QTreeWidget(parent), desk_(desk) {
    setObjectName("spot_tree");
    setAccessibleName(tr("Spots and regions"));
    setToolTip(tr("Spots in the order of measuring, and regions with their spots"));
    setColumnCount(2);
    setHeaderLabels({tr("Name"), tr("State")});
    header()->setSectionResizeMode(0, QHeaderView::Stretch);
    header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
    header()->setStretchLastSection(false);
    setUniformRowHeights(true);
    setMinimumHeight(190);
    setIndentation(16);
    connect(this, &QTreeWidget::currentItemChanged, this, [this](QTreeWidgetItem* item) {
        if (filling_ || !item) return;
        const std::string id = item->data(0, kId).toString().toStdString();
        const QString kind = item->data(0, kKind).toString();
        if (kind == "spot") desk_.selection().select_spot(id);
        if (kind == "region") desk_.selection().select_region(id);
    });
    // Queued: the items are made anew, and the click that selected one is still at work on it.
    connect(
        &desk_.selection(), &Selection::changed, this,
        [this] {
            if (isVisible()) refresh();
        },
        Qt::QueuedConnection);
}

bool SpotTree::on_spot() const {
    return currentItem() && currentItem()->data(0, kKind).toString() == "spot";
}

void SpotTree::refresh() {
    filling_ = true;
    const QTreeWidgetItem* before = currentItem();
    const bool region_current = before && before->data(0, kKind).toString() == "region";
    clear();
    const Project& p = desk_.project();
    const auto make = [](QTreeWidgetItem* parent, const QString& kind, const std::string& id,
                         const QString& state) {
        auto* item = new QTreeWidgetItem(parent, {QString::fromStdString(id), state});
        item->setData(0, kKind, kind);
        item->setData(0, kId, QString::fromStdString(id));
        item->setSizeHint(0, {0, style::kTargetPx});
        return item;
    };
    const auto state_of = [&](const Spot& s) {
        return !s.enabled                                          ? tr("disabled")
               : s.reference_profile.size() == 0                   ? tr("no reference")
               : s.reference_state == ReferenceState::from_drawing ? tr("from the drawing")
               : s.reference_state == ReferenceState::from_type    ? tr("of another part type")
               : frozen_open(p, desk_.facts(), s)                  ? tr("taught, pass open")
                                                                   : tr("taught, pass accepted");
    };
    const auto owned = [](const std::string& type_id, const QString& state) {
        return type_id.empty() ? state : QString::fromStdString(type_id) + ": " + state;
    };
    auto* spots = new QTreeWidgetItem(this, {tr("Spots (%1)").arg(p.spots.size()), {}});
    spots->setSizeHint(0, {0, style::kTargetPx});
    QTreeWidgetItem* current = nullptr;
    for (const Spot& s : p.spots) {
        auto* item = make(spots, "spot", s.id, owned(s.type_id, state_of(s)));
        if (s.id == desk_.selection().spot()) current = item;
    }
    auto* regions = new QTreeWidgetItem(this, {tr("Regions (%1)").arg(p.regions.size()), {}});
    for (const Region& r : p.regions) {
        auto* item = make(regions, "region", r.id,
                          owned(r.type_id, tr("%n spot(s)", "", static_cast<int>(r.spot_ids.size()))));
        for (const std::string& id : r.spot_ids)
            if (const Spot* s = find_spot(p, id)) make(item, "spot", id, state_of(*s));
        if (region_current && r.id == desk_.selection().region()) current = item;
    }
    for (QTreeWidgetItem* group : {spots, regions}) {
        group->setExpanded(true);
        group->setFirstColumnSpanned(true);
    }
    if (current) {
        setCurrentItem(current);
        scrollToItem(current);
    }
    filling_ = false;
}

}  // namespace seamwright
