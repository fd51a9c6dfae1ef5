#pragma once
// How a sensor's frames become profiles: its peaks and its stripe model, a line each; every change is an undoable edit.

#include <QWidget>
#include <vector>

#include "widgets/desk/desk.h"
#include "widgets/editors/parameter_editor.h"

namespace seamwright {

class StripePanel : public QWidget {
    Q_OBJECT
  public:
    explicit StripePanel(Desk& desk, QWidget* parent = nullptr);
    void refresh(const SensorSetup* sensor);  // nullptr: none is selected

  signals:
    void refused(const seamwright::Error& error);  // an edit

  private:
    Desk& desk_;
    std::string sensor_id_;
    std::vector<ParameterEditor*> editors_;  // as sensor_fields()
};

}  // namespace seamwright
