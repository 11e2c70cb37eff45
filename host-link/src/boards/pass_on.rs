//! Forwarding of [`Boards`](super::Boards) methods by wrappers around other boards.

/// In an `impl Boards`: passes the methods that are named on to the boards in a field.
///
/// An `ask` that is neither named nor written is a `request`, as in every [`Boards`](crate::boards::Boards).
#[macro_export]
macro_rules! pass_on {
    ($boards:tt: $($method:ident),+) => {
        $($crate::pass_on! { @$method $boards })+
    };
    (@request $boards:tt) => {
        fn request(
            &mut self,
            role: ::shared::protocol::Role,
            request: &::shared::protocol::Request,
        ) -> Result<::shared::protocol::Response, $crate::boards::LinkError> {
            self.$boards.request(role, request)
        }
    };
    (@ask $boards:tt) => {
        fn ask(
            &mut self,
            role: ::shared::protocol::Role,
            request: &::shared::protocol::Request,
        ) -> Result<Option<::shared::protocol::Response>, $crate::boards::LinkError> {
            self.$boards.ask(role, request)
        }
    };
    (@answer $boards:tt) => {
        fn answer(
            &mut self,
            role: ::shared::protocol::Role,
        ) -> Result<Option<::shared::protocol::Response>, $crate::boards::LinkError> {
            self.$boards.answer(role)
        }
    };
    (@waker $boards:tt) => {
        fn waker(&self) -> Option<$crate::boards::Waker> {
            self.$boards.waker()
        }
    };
    (@dropped_datagrams $boards:tt) => {
        fn dropped_datagrams(&self) -> u32 {
            self.$boards.dropped_datagrams()
        }
    };
    (@last_stall $boards:tt) => {
        fn last_stall(&self) -> Option<$crate::boards::Stall> {
            self.$boards.last_stall()
        }
    };
    (@receive $boards:tt) => {
        fn receive(
            &mut self,
            timeout: ::std::time::Duration,
        ) -> Result<Option<(::shared::protocol::Role, ::shared::protocol::Datagram)>, $crate::boards::LinkError> {
            self.$boards.receive(timeout)
        }
    };
    (@send $boards:tt) => {
        fn send(
            &mut self,
            role: ::shared::protocol::Role,
            datagram: &::shared::protocol::Datagram,
        ) -> Result<(), $crate::boards::LinkError> {
            self.$boards.send(role, datagram)
        }
    };
    (@now $boards:tt) => {
        fn now(&self) -> ::std::time::Duration {
            self.$boards.now()
        }
    };
    (@identity $boards:tt) => {
        fn identity(&self, role: ::shared::protocol::Role) -> Option<&::shared::protocol::Identity> {
            self.$boards.identity(role)
        }
    };
    (@path_states_target $boards:tt) => {
        fn path_states_target(&self) -> Option<::shared::protocol::Request> {
            self.$boards.path_states_target()
        }
    };
}
