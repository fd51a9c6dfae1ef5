#pragma once
// The light of a spot: what the sensor is set to there, and to have it found on the part.

#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include "projects/station/light/spot_light.h"
#include "widgets/desk/desk.h"

namespace seamwright {

// "Exposure 812 µs, Gain 0 dB; merged from 250, 2000 µs"; what the spot sets, or that it sets nothing.
QString light_words(const SpotLight& light);

class SpotLightPanel : public QWidget {
    Q_OBJECT
  public:
    explicit SpotLightPanel(Desk& desk, QWidget* parent = nullptr);
    void refresh(const Spot* spot);  // nullptr: none is selected

  signals:
    void refused(const seamwright::Error& error);  // an edit

  private:
    void take(const Spot& asked, const FoundLight& found);
    void edit(const Spot& after, const QString& what);

    Desk& desk_;
    std::string spot_id_;
    QLabel *now_, *said_;
    QPushButton *find_, *clear_;
};

}  // namespace seamwright
