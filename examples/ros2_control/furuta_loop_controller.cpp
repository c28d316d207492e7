// A ros2_control controller whose update() is one sample of an exported loop:
//
//     ./furuta export c --rig paper --set compensation=lugre --out loop
//
// Compile it with loop/loop.c. The controller manager's update_rate must be 1/LOOP_SAMPLE_TIME.
// The hardware must give positions and velocities in rad and rad/s (pendulum: 0 upright) and the
// voltage that it applied since the last sample as the arm's effort; the command is a voltage.
// docs/export.md says what a reading may be.

#include <cmath>

#include "controller_interface/controller_interface.hpp"
#include "loop.h"
#include "pluginlib/class_list_macros.hpp"

namespace furuta_example {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

class FurutaLoopController : public controller_interface::ControllerInterface {
public:
    CallbackReturn on_init() override { return CallbackReturn::SUCCESS; }

    InterfaceConfiguration command_interface_configuration() const override {
        return {interface_configuration_type::INDIVIDUAL, {"arm/effort"}};
    }

    InterfaceConfiguration state_interface_configuration() const override {
        return {interface_configuration_type::INDIVIDUAL,
                {"arm/position", "arm/velocity", "pendulum/position", "arm/effort"}};
    }

    CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
        loop_init(&loop_);
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override {
        return command_interfaces_[0].set_value(0.0) ? CallbackReturn::SUCCESS
                                                     : CallbackReturn::ERROR;
    }

    return_type update(const rclcpp::Time &, const rclcpp::Duration &) override {
        const auto read = [this](std::size_t i) {
            return static_cast<LOOP_REAL>(state_interfaces_[i].get_optional().value_or(NAN));
        };
        const loop_reading reading = {read(0), read(1), read(2), static_cast<LOOP_REAL>(NAN), read(3)};
        loop_command command;
        loop_step(&loop_, &reading, &command);
        // While the interface is locked, the last command stays.
        (void)command_interfaces_[0].set_value(static_cast<double>(command.voltage));
        return return_type::OK;
    }

private:
    loop_memory loop_;
};

}  // namespace furuta_example

PLUGINLIB_EXPORT_CLASS(furuta_example::FurutaLoopController,
                       controller_interface::ControllerInterface)
