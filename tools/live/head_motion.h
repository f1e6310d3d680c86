// The simulated head's servos behind an emulated bus, so that driver, wire and plant are all in the loop.
#pragma once

#include <memory>
#include <mutex>

#include "drivers/head/sim_head.h"
#include "drivers/servo/servo_map.h"
#include "drivers/servo/servo_motion.h"

namespace tectum {

/// One joint of `head`, moved by the emulated servo that `map` gives it. The head's virtual time follows the bus's:
/// head time = bus time - `start_ns`, and it never runs backwards. `mutex` guards the head against its cameras' reader.
/// What the head does not model (torque limit, moving speed, compliance from registers, load) has no effect.
[[nodiscard]] std::unique_ptr<ServoMotion> make_head_motion(SimHead& head, std::mutex& mutex, const ServoMap& map,
                                                            Joint joint, TimeNs start_ns);

}  // namespace tectum
