#include "widgets/pages/parts/type_chooser.h"

#include <QSignalBlocker>
#include <QVBoxLayout>

#include "projects/model/part_types.h"
#include "widgets/pages/parts/form.h"

namespace seamwright {

TypeChooser::TypeChooser(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk), types_(new QComboBox) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    types_->setObjectName("part_type");
    types_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    types_->setMinimumContentsLength(12);
    add_field(*box, tr("Part type"), types_,
              tr("Whose spots are measured and whose regions are pushed; those of the other types stay"));
    connect(types_, &QComboBox::activated, this,
            [this] { desk_.selection().select_part_type(types_->currentData().toString().toStdString()); });
    connect(&desk_, &Desk::project_changed, this, &TypeChooser::refresh);
    connect(&desk_, &Desk::opened, this, &TypeChooser::refresh);
    connect(&desk_.selection(), &Selection::changed, this, &TypeChooser::refresh);
    refresh();
}

void TypeChooser::refresh() {
    const QSignalBlocker quiet(types_);
    types_->clear();
    for (const PartType& type : desk_.project().part_types)
        types_->addItem(QString::fromStdString(name_of(type)), QString::fromStdString(type.id));
    types_->setCurrentIndex(types_->findData(QString::fromStdString(desk_.selection().part_type())));
    setVisible(types_->count() > 0);
}

}  // namespace seamwright
