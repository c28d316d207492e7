// A chainable ros2_control controller that adds the friction of a joint to the effort that another
// controller commands:
//
//     ./furuta export c --axis joints.yaml --joint elbow_joint --out axis
//
// Compile it with axis/axis.c. A controller in front, such as a PID or a trajectory controller,
// commands <name of this controller>/<joint>/effort. Without one only friction is compensated.
// The controller manager's update_rate, or that of this controller, must be 1/AXIS_SAMPLE_TIME.
//
// Parameters:
//     joint            name of the joint
//     measures_effort  whether the hardware has the state effort (default); if not, the command
//                      counts as the effort, so the hardware must not limit it further

#include <cmath>
#include <string>
#include <vector>

#include "axis.h"
#include "controller_interface/chainable_controller_interface.hpp"
#include "pluginlib/class_list_macros.hpp"
#include "rclcpp/logging.hpp"

namespace furuta_example {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

class JointFrictionController : public controller_interface::ChainableControllerInterface {
public:
    CallbackReturn on_init() override {
        auto_declare<std::string>("joint", "");
        auto_declare<bool>("measures_effort", true);
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
        joint_ = get_node()->get_parameter("joint").as_string();
        measures_effort_ = get_node()->get_parameter("measures_effort").as_bool();
        const double samples = get_update_rate() * static_cast<double>(AXIS_SAMPLE_TIME);
        if (!joint_.empty() && std::abs(samples - 1.0) < 0.01) {
            return CallbackReturn::SUCCESS;
        }
        RCLCPP_ERROR(get_node()->get_logger(),
                     "joint must be given and update_rate be %.0f Hz, given '%s' and %u Hz",
                     1.0 / static_cast<double>(AXIS_SAMPLE_TIME), joint_.c_str(),
                     get_update_rate());
        return CallbackReturn::FAILURE;
    }

    InterfaceConfiguration command_interface_configuration() const override {
        return {interface_configuration_type::INDIVIDUAL, {joint_ + "/effort"}};
    }

    InterfaceConfiguration state_interface_configuration() const override {
        std::vector<std::string> names = {joint_ + "/position", joint_ + "/velocity"};
        if (measures_effort_) {
            names.push_back(joint_ + "/effort");
        }
        return {interface_configuration_type::INDIVIDUAL, names};
    }

    CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
        axis_init(&axis_);
        command_ = NAN;
        reference_interfaces_[0] = 0.0;
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override {
        return command_interfaces_[0].set_value(0.0) ? CallbackReturn::SUCCESS
                                                     : CallbackReturn::ERROR;
    }

protected:
    std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override {
        reference_interfaces_.assign(1, 0.0);
        std::vector<hardware_interface::CommandInterface> exported;
        exported.emplace_back(get_node()->get_name(), joint_ + "/effort",
                              reference_interfaces_.data());
        return exported;
    }

    return_type update_reference_from_subscribers(const rclcpp::Time &,
                                                  const rclcpp::Duration &) override {
        reference_interfaces_[0] = 0.0;
        return return_type::OK;
    }

    return_type update_and_write_commands(const rclcpp::Time &,
                                          const rclcpp::Duration &) override {
        const auto read = [this](std::size_t i) {
            return static_cast<AXIS_REAL>(state_interfaces_[i].get_optional().value_or(NAN));
        };
        const AXIS_REAL effort = measures_effort_ ? read(2) : static_cast<AXIS_REAL>(command_);
        const AXIS_REAL none = NAN;
        const AXIS_REAL friction = axis_friction(&axis_, read(0), read(1), effort, none);
        const double command = reference_interfaces_[0] + static_cast<double>(friction);
        // While the interface is locked, the last command stays.
        if (command_interfaces_[0].set_value(command)) {
            command_ = command;
        }
        return return_type::OK;
    }

private:
    std::string joint_;
    bool measures_effort_ = true;
    double command_ = NAN;  // the last that was written
    axis_memory axis_;
};

}  // namespace furuta_example

PLUGINLIB_EXPORT_CLASS(furuta_example::JointFrictionController,
                       controller_interface::ChainableControllerInterface)
