#include "widgets/pages/parts/stripe_panel.h"

#include <QVBoxLayout>

#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "widgets/pages/parts/form.h"

namespace seamwright {

StripePanel::StripePanel(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk) {
    auto* in = new QVBoxLayout(this);
    in->setContentsMargins(0, 0, 0, 0);
    in->addWidget(make_heading(tr("Stripe in the image")));
    for (const Field<SensorSetup>& f : sensor_fields()) {
        if (editors_.size() == kPeakFields) in->addWidget(make_heading(tr("Filter of the profile")));
        auto* editor = new ParameterEditor(f.info);
        editor->setObjectName(QString::fromStdString("stripe_" + f.info.name));
        connect(editor, &ParameterEditor::committed, this, [this, name = f.info.name](double value) {
            const auto done = desk_.set_sensor_field(SensorId(sensor_id_), name, value);
            if (done) return;
            emit refused(done.error());
            refresh(find_sensor(desk_.project(), sensor_id_));  // the value that holds
        });
        in->addWidget(editor);
        editors_.push_back(editor);
    }
}

void StripePanel::refresh(const SensorSetup* sensor) {
    setVisible(sensor != nullptr);
    if (!sensor) return;
    sensor_id_ = sensor->id;
    const std::string of = desk_.path().string() + '\n' + sensor_id_;
    for (std::size_t i = 0; i < editors_.size(); ++i)
        editors_[i]->refresh(sensor_fields()[i].get(*sensor), of);
}

}  // namespace seamwright
