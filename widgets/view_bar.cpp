#include "widgets/view_bar.h"

#include "widgets/flow_layout.h"
#include "widgets/style.h"

namespace seamwright {

ViewBar::ViewBar(QWidget* parent, const QString& caption)
    : QWidget(parent), row_(new FlowLayout(this, true)), caption_(new QLabel(caption, this)) {
    row_->setContentsMargins(8, 2, 4, 2);
    row_->setSpacing(0);
    row_->addWidget(caption_);
}

QToolButton* ViewBar::add(const QString& word, const QString& tip, bool checkable) {
    auto* made = new QToolButton(this);
    made->setText(word);
    made->setToolTip(tip);
    made->setAccessibleName(word);
    made->setCheckable(checkable);
    made->setAutoRaise(true);
    made->setMinimumHeight(style::kTargetPx);
    row_->addWidget(made);
    return made;
}

}  // namespace seamwright
