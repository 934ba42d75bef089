#include "runtime/calib/observer.h"

namespace roomcal::calib {

Status Steps::begin(Stage stage, std::string_view sensor) {
  if (begun_) ++progress_.done;
  begun_ = true;
  progress_.stage = stage;
  progress_.sensor = sensor;
  if (observer_ == nullptr || observer_->on_step(progress_)) return ok_status();
  return {StatusCode::kCancelled, "the observer stopped the session"};
}

}  // namespace roomcal::calib
