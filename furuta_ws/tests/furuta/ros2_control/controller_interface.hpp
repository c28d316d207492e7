// Stand-in for the headers of ros2_control (Jazzy): what the examples use, with its signatures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__))

namespace rclcpp {
class Time {};
class Duration {};
class Logger {};

struct Parameter {
    std::variant<bool, std::string> value;
    bool as_bool() const { return std::get<bool>(value); }
    std::string as_string() const { return std::get<std::string>(value); }
};
}  // namespace rclcpp

namespace rclcpp_lifecycle {
class State {};

struct LifecycleNode {
    std::map<std::string, rclcpp::Parameter> parameters;
    const char *get_name() const { return "controller"; }
    rclcpp::Logger get_logger() const { return {}; }
    rclcpp::Parameter get_parameter(const std::string &name) const { return parameters.at(name); }
};
}  // namespace rclcpp_lifecycle

namespace hardware_interface {

class CommandInterface {
public:
    CommandInterface(const std::string &prefix_name, const std::string &interface_name,
                     double *value_ptr)
        : name(prefix_name + "/" + interface_name), value(value_ptr) {}
    CommandInterface(const CommandInterface &) = delete;
    CommandInterface(CommandInterface &&) = default;

    std::string name;
    double *value;
};

struct LoanedInterface {
    double value = 0.0;
    [[nodiscard]] std::optional<double> get_optional() const { return value; }
    [[nodiscard]] bool set_value(const double &given) { return value = given, true; }
};

}  // namespace hardware_interface

namespace controller_interface {

enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration {
    interface_configuration_type type = interface_configuration_type::NONE;
    std::vector<std::string> names = {};
};

class ControllerInterfaceBase {
public:
    virtual ~ControllerInterfaceBase() = default;
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual CallbackReturn on_init() = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) {
        return CallbackReturn::SUCCESS;
    }
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
    virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) = 0;
    virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;
    unsigned int get_update_rate() const { return 500; }
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
    template <typename ParameterT>
    auto auto_declare(const std::string &name, const ParameterT &default_value) {
        return node_->parameters.try_emplace(name, rclcpp::Parameter{default_value}), default_value;
    }

protected:
    std::vector<hardware_interface::LoanedInterface> command_interfaces_{1};
    std::vector<hardware_interface::LoanedInterface> state_interfaces_{4};

private:
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ =
        std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

class ControllerInterface : public ControllerInterfaceBase {};

class ChainableControllerInterface : public ControllerInterfaceBase {
public:
    return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) final {
        return update_and_write_commands(time, period);
    }

protected:
    virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
    virtual return_type update_reference_from_subscribers(const rclcpp::Time &,
                                                          const rclcpp::Duration &) = 0;
    virtual return_type update_and_write_commands(const rclcpp::Time &,
                                                  const rclcpp::Duration &) = 0;
    std::vector<double> reference_interfaces_;
};

}  // namespace controller_interface
