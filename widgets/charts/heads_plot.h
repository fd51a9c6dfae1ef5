#pragma once
// What the heads of one place saw about the gap, and the one profile that became of it; true to scale.

#include <QStringList>
#include <QWidget>
#include <vector>

#include "core/profile/profile.h"

namespace seamwright {

class PlotCanvas;

class HeadsPlot : public QWidget {
    Q_OBJECT
  public:
    explicit HeadsPlot(QWidget* parent = nullptr);
    // In one frame; a name for each head. Of a single head `merged` is what was measured in. `middle`: of the gap. Empty:
    // none yet.
    void set_profiles(const QStringList& names, const std::vector<Profile>& heads, const Profile& merged,
                      QPointF middle = {});
    int curves() const;  // that are drawn
    QSize sizeHint() const override { return {380, 220}; }
    QSize minimumSizeHint() const override { return {240, 150}; }

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void draw();

    PlotCanvas* canvas_;
    QStringList names_;
    std::vector<Profile> heads_;
    Profile merged_;
    QPointF middle_;
};

}  // namespace seamwright
