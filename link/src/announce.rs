//! Announces the board's address to the network at boot: a first datagram to an unknown board
//! would wait a second for the repeated ARP request.

use smoltcp::phy::{Device, TxToken};
use smoltcp::time::Instant;
use smoltcp::wire::{
    ArpOperation, ArpPacket, ArpRepr, EthernetAddress, EthernetFrame, EthernetProtocol, Ipv4Address,
};

/// Sends a gratuitous ARP request, if the device has room for it.
pub(crate) fn announce(
    device: &mut (impl Device + ?Sized),
    mac: EthernetAddress,
    ip: Ipv4Address,
    now: Instant,
) {
    let arp = ArpRepr::EthernetIpv4 {
        operation: ArpOperation::Request,
        source_hardware_addr: mac,
        source_protocol_addr: ip,
        target_hardware_addr: EthernetAddress([0; 6]),
        target_protocol_addr: ip,
    };
    let header = EthernetFrame::<&[u8]>::header_len();
    if let Some(token) = device.transmit(now) {
        token.consume(header + arp.buffer_len(), |bytes| {
            let mut frame = EthernetFrame::new_unchecked(bytes);
            frame.set_src_addr(mac);
            frame.set_dst_addr(EthernetAddress::BROADCAST);
            frame.set_ethertype(EthernetProtocol::Arp);
            arp.emit(&mut ArpPacket::new_unchecked(frame.payload_mut()));
        });
    }
}
