#pragma once
// What is chosen, for all views at once: tree, plot and scene follow it and write to it.

#include <QObject>
#include <string>

namespace seamwright {

class Selection : public QObject {
    Q_OBJECT
  public:
    using QObject::QObject;
    const std::string& spot() const { return spot_; }
    const std::string& region() const { return region_; }
    const std::string& sensor() const { return sensor_; }
    const std::string& part_type() const { return part_type_; }  // that is measured; "" where there are none
    void select_spot(const std::string& id);                     // "" = none
    void select_region(const std::string& id);
    void select_sensor(const std::string& id);
    void select_part_type(const std::string& id);

  signals:
    void changed();

  private:
    std::string spot_, region_, sensor_, part_type_;
};

}  // namespace seamwright
