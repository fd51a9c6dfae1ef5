#pragma once
// The settings of a driver as its table describes them (devices/exchange/settings.h): a line for each with name, unit
// and what an absent one means, fields of objects behind a heading. Those that are set, those without a default and the
// table's first few are shown, the others on demand.
//
// What a person changes is written into the JSON at once; an empty field takes the setting out again. What is no
// number, out of range or no JSON stays in the field, marked by the word "refused" and the reason, and is not written;
// Escape brings back what is. Settings that the table does not hold stay in the JSON untouched.

#include <QWidget>
#include <memory>

#include "devices/exchange/settings.h"

class QLabel;

namespace seamwright {

class SettingsEditor : public QWidget {
    Q_OBJECT
  public:
    explicit SettingsEditor(QWidget* parent = nullptr);
    ~SettingsEditor() override;
    void set_table(const SettingTable& table);       // with empty settings
    void set_value(const nlohmann::json& settings);  // no signal
    const nlohmann::json& value() const;
    bool refused() const;  // of any field
    void show_refused();   // gives the first of them the focus and scrolls to it
    void show_all(bool all);

  signals:
    void edited();  // by a person; read value()

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    struct Row;
    struct Impl;
    QLabel* heading_for(const SettingInfo& s, int depth);
    QWidget* editor_of(Row* row);
    void add_row(const SettingInfo& s, const nlohmann::json::json_pointer& at, int depth, bool essential);
    void add_rows(const SettingTable& fields, const nlohmann::json::json_pointer& under, int depth);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
